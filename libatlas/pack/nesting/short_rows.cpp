#include <bit>
#include <cstring>
#include <utility>

#include "libatlas/core/wide_vectors.h"
#include "libatlas/pack/nesting/bit_page.h"

// GCC warns that functions pass such vectors differently with and without AVX. Here only inlined
// functions take or return them.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace atlas::pack {
namespace {

using Words = std::uint64_t __attribute__((vector_size(32)));
using HalfWords = std::uint64_t __attribute__((vector_size(16)));
using SignedWords = std::int64_t __attribute__((vector_size(32)));

ATLAS_INLINE Words load(const std::uint64_t* from) {
  Words words;
  std::memcpy(&words, from, sizeof words);
  return words;
}
ATLAS_INLINE void store(Words words, std::uint64_t* to) {
  std::memcpy(to, &words, sizeof words);
}

// Returns words moved down by `shift` < 64 bits. `next` are the words that follow each.
ATLAS_INLINE Words moved_down(Words words, Words next, unsigned shift) {
  return words >> shift | next << 1 << (63 - shift);
}

// Four words of the bits of a, followed by those of b, from a word of a on.
template <int kFirst>
ATLAS_INLINE Words words_from(Words a, Words b) {
  return __builtin_shufflevector(a, b, kFirst, kFirst + 1, kFirst + 2, kFirst + 3);
}

// The bits of a row of four or eight words.
template <int kVectors>
struct Bits {
  Words at[kVectors];

  ATLAS_INLINE static Bits load_from(const std::uint64_t* from) {
    Bits bits;
    for (int v = 0; v < kVectors; ++v) bits.at[v] = load(from + 4 * v);
    return bits;
  }
  ATLAS_INLINE void store_to(std::uint64_t* to) const {
    for (int v = 0; v < kVectors; ++v) store(at[v], to + 4 * v);
  }

  // Bits first .. last of the row. Words are compared as signed numbers, because processors have
  // no instruction for others.
  ATLAS_INLINE static Bits range(std::uint32_t first, std::uint32_t last) {
    const std::uint64_t all = ~std::uint64_t{0};
    const auto low = std::int64_t(first / 64), high = std::int64_t(last / 64);
    const std::uint64_t from = all << (first % 64), to = all >> (63 - last % 64);
    Bits bits;
    for (int v = 0; v < kVectors; ++v) {
      const SignedWords word = SignedWords{0, 1, 2, 3} + std::int64_t(4 * v);
      bits.at[v] = (Words(word > low) | (Words(word == low) & from)) &
                   (Words(word < high) | (Words(word == high) & to));
    }
    return bits;
  }

  // Keeps the bits x for which bit x + shift from `bits` on is set, with shift < 64.
  ATLAS_INLINE void narrow(const std::uint64_t* bits, unsigned shift) {
    for (int v = 0; v < kVectors; ++v)
      at[v] &= moved_down(load(bits + 4 * v), load(bits + 4 * v + 1), shift);
  }

  // Keeps the bits x for which bit x + kStep is set, too. Bits beyond the row are not.
  template <int kStep>
  ATLAS_INLINE void narrow() {
    const Words none{};
    for (int v = 0; v < kVectors; ++v) {
      const Words beyond = v + 1 < kVectors ? at[v + 1] : none;
      if constexpr (kStep < 64) {
        at[v] &= moved_down(at[v], words_from<1>(at[v], beyond), unsigned(kStep));
      } else if constexpr (kStep < 256) {
        at[v] &= words_from<kStep / 64>(at[v], beyond);
      } else {
        at[v] &= beyond;
      }
    }
  }

  ATLAS_INLINE bool none() const {
    Words any = at[0];
    for (int v = 1; v < kVectors; ++v) any |= at[v];
    const HalfWords half =
        __builtin_shufflevector(any, any, 0, 1) | __builtin_shufflevector(any, any, 2, 3);
    return (half[0] | half[1]) == 0;
  }

  // Returns the first bit that is set. There must be one.
  ATLAS_INLINE std::int32_t first() const {
    std::int32_t first = 0;
    for (int w = 4 * kVectors - 1; w >= 0; --w) {
      const std::uint64_t word = at[w / 4][w % 4];
      if (word != 0) first = 64 * w + std::countr_zero(word);
    }
    return first;
  }
};

// Derives the levels of a row, all that it can have, each from the one below.
template <int kVectors>
class Levels {
 public:
  // `bits` is level 0 in the page, which is followed by the others that the page has.
  ATLAS_INLINE Levels(std::uint64_t* bits, int levels)
      : bits_(bits), levels_(levels), row_(Bits<kVectors>::load_from(bits)) {
    keep(0);
    derive(std::make_integer_sequence<int, kHighest>());
  }

  // Returns the length of the longest free run. It comes from the highest level that has bits left,
  // because this has the fewest runs of bits.
  ATLAS_INLINE std::int32_t longest() const {
    return top_ < 0 ? 0 : longest_run(free_[top_]) + (1 << top_) - 1;
  }

 private:
  static constexpr int kStride = 4 * kVectors, kHighest = std::bit_width(64u * kStride) - 1;

  template <int... kBelow>
  ATLAS_INLINE void derive(std::integer_sequence<int, kBelow...>) {
    (derive_from<kBelow>(), ...);
  }
  template <int kBelow>
  ATLAS_INLINE void derive_from() {
    row_.template narrow<1 << kBelow>();
    keep(kBelow + 1);
    if (kBelow + 1 < levels_) row_.store_to(bits_ + (kBelow + 1) * kStride);
  }
  ATLAS_INLINE void keep(int level) {
    row_.store_to(free_[level]);
    if (!row_.none()) top_ = level;
  }

  std::uint64_t* bits_;
  int levels_;
  Bits<kVectors> row_;  // the last level
  int top_ = -1;
  std::uint64_t free_[kHighest + 1][kStride];  // one row per level
};

}  // namespace

struct BitPage::ShortRows {
  struct Sought {
    const MaskTests& tests;
    const Window& window;
    RecentProbes& recent;
  };

  // The places that are left for a mask whose foot is in row window.y0.
  template <int kVectors>
  struct Row {
    const std::uint64_t* foot;
    std::size_t levels;
    std::int32_t rows;  // that exist from the foot on; those above are free
    Bits<kVectors> left;
    std::uint64_t tested = 0;

    ATLAS_INLINE Row(const BitPage& page, const Window& window)
        : foot(page.row(0, window.y0)),
          levels(static_cast<std::size_t>(page.levels_)),
          rows(page.rows_ - window.y0),
          left(Bits<kVectors>::range(static_cast<std::uint32_t>(window.x0),
                                     static_cast<std::uint32_t>(window.x1))) {}

    // Makes a probe. Returns whether any place is left.
    ATLAS_INLINE bool left_by(const Probe& p) {
      if (p.row >= rows) return true;
      const std::size_t row = std::size_t(p.row) * levels + p.level;
      // Words beyond the row's end are read, but no candidate reaches them.
      left.narrow(foot + row * (4 * kVectors) + p.offset / 64, p.offset % 64);
      ++tested;
      return !left.none();
    }
  };

  // Finds the leftmost place with the foot in row window.y0.
  template <int kVectors>
  ATLAS_INLINE static bool find_in(BitPage& page, const Sought& sought, Place& place) {
    const auto& [tests, window, recent] = sought;
    // What a call takes beside its probes, in probes. The budget of work ends searches, so this
    // number also decides how many layouts are tried: with four, machine parts filled 0.3 % less.
    constexpr std::uint64_t kCall = 2;
    Row<kVectors> row(page, window);
    bool found = true;
    for (std::size_t k = 0; k < recent.size() && found; ++k) {
      found = row.left_by(tests.probes[recent[k]]);
      if (!found) recent.again(k);
    }
    const Probe* first = tests.probes.data();
    const Probe* end = first + tests.probes.size();
    for (const Probe* p = first; p != end && found; ++p) {
      found = row.left_by(*p);
      if (!found) recent.add(static_cast<std::size_t>(p - first));
    }
    const auto span =
        static_cast<std::uint64_t>(window.x1) / 64 + 1 - static_cast<std::uint64_t>(window.x0) / 64;
    page.work_ += (row.tested + kCall) * span;
    if (found) place = {row.left.first(), window.y0};
    return found;
  }

  template <int kVectors>
  ATLAS_INLINE static void rebuild_in(BitPage& page, std::int32_t y) {
    page.set_longest(y, Levels<kVectors>(page.row(0, y), page.levels_).longest());
  }

  // The same functions compiled for processors with and without wide vectors.
  template <int kVectors>
  static bool find_narrow(BitPage& page, const Sought& sought, Place& place) {
    return find_in<kVectors>(page, sought, place);
  }
  template <int kVectors>
  ATLAS_WIDE static bool find_wide(BitPage& page, const Sought& sought, Place& place) {
    return find_in<kVectors>(page, sought, place);
  }
  template <int kVectors>
  static void rebuild_narrow(BitPage& page, std::int32_t y) {
    rebuild_in<kVectors>(page, y);
  }
  template <int kVectors>
  ATLAS_WIDE static void rebuild_wide(BitPage& page, std::int32_t y) {
    rebuild_in<kVectors>(page, y);
  }

  template <int kVectors>
  static bool find(BitPage& page, const Sought& sought, Place& place) {
    return (has_wide_vectors ? find_wide<kVectors> : find_narrow<kVectors>)(page, sought, place);
  }
  template <int kVectors>
  static void rebuild(BitPage& page, std::int32_t y) {
    (has_wide_vectors ? rebuild_wide<kVectors> : rebuild_narrow<kVectors>)(page, y);
  }
};

bool BitPage::find_in_short_row(const MaskTests& tests, const Window& window, RecentProbes& recent,
                                Place& place) {
  const ShortRows::Sought sought{tests, window, recent};
  return (words_ == 4 ? ShortRows::find<1> : ShortRows::find<2>)(*this, sought, place);
}

void BitPage::rebuild_short_row(std::int32_t y) {
  (words_ == 4 ? ShortRows::rebuild<1> : ShortRows::rebuild<2>)(*this, y);
}

}  // namespace atlas::pack
