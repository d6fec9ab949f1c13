#include "libatlas/scene/gltf/draco_guard.h"

#include <draco/compression/attributes/sequential_attribute_decoders_controller.h>
#include <draco/compression/attributes/sequential_integer_attribute_decoder.h>
#include <draco/compression/attributes/sequential_quantization_attribute_decoder.h>
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/core/varint_decoding.h>

#include <cstdint>
#include <memory>
#include <utility>

namespace atlas {
namespace {

using Scheme = draco::PredictionSchemeTypedDecoderInterface<std::int32_t>;
using Controller = draco::SequentialAttributeDecodersController;

// A prediction of texture coordinates, whose bits are counted before it decodes them.
class GuardedScheme : public Scheme {
 public:
  GuardedScheme(std::unique_ptr<Scheme> scheme, std::uint32_t most)
      : scheme_(std::move(scheme)), most_(most) {}

  bool DecodePredictionData(draco::DecoderBuffer* buffer) override {
    draco::DecoderBuffer ahead = *buffer;
    std::uint32_t count = 0;
    const bool known = GetPredictionMethod() == draco::MESH_PREDICTION_TEX_COORDS_PORTABLE
                           ? ahead.Decode(&count)
                           : draco::DecodeVarint(&count, &ahead);
    return known && count <= most_ && scheme_->DecodePredictionData(buffer);
  }

  bool ComputeOriginalValues(const std::int32_t* in, std::int32_t* out, int size, int components,
                             const draco::PointIndex* points) override {
    return scheme_->ComputeOriginalValues(in, out, size, components, points);
  }
  draco::PredictionSchemeMethod GetPredictionMethod() const override {
    return scheme_->GetPredictionMethod();
  }
  const draco::PointAttribute* GetAttribute() const override { return scheme_->GetAttribute(); }
  bool IsInitialized() const override { return scheme_->IsInitialized(); }
  int GetNumParentAttributes() const override { return scheme_->GetNumParentAttributes(); }
  draco::GeometryAttribute::Type GetParentAttributeType(int i) const override {
    return scheme_->GetParentAttributeType(i);
  }
  bool SetParentAttribute(const draco::PointAttribute* attribute) override {
    return scheme_->SetParentAttribute(attribute);
  }
  bool AreCorrectionsPositive() override { return scheme_->AreCorrectionsPositive(); }
  draco::PredictionSchemeTransformType GetTransformType() const override {
    return scheme_->GetTransformType();
  }

 private:
  std::unique_ptr<Scheme> scheme_;
  std::uint32_t most_;
};

template <class Decoder>
class GuardedAttribute : public Decoder {
 public:
  explicit GuardedAttribute(std::uint32_t most) : most_(most) {}

 protected:
  std::unique_ptr<Scheme> CreateIntPredictionScheme(
      draco::PredictionSchemeMethod method,
      draco::PredictionSchemeTransformType transform) override {
    auto scheme = Decoder::CreateIntPredictionScheme(method, transform);
    const bool texcoords = method == draco::MESH_PREDICTION_TEX_COORDS_PORTABLE ||
                           method == draco::MESH_PREDICTION_TEX_COORDS_DEPRECATED;
    if (!scheme || !texcoords || scheme->GetPredictionMethod() != method) return scheme;
    return std::make_unique<GuardedScheme>(std::move(scheme), most_);
  }

 private:
  std::uint32_t most_;
};

class GuardedController : public Controller {
 public:
  GuardedController(std::unique_ptr<draco::PointsSequencer> sequencer, std::uint32_t most)
      : Controller(std::move(sequencer)), most_(most) {}

 protected:
  std::unique_ptr<draco::SequentialAttributeDecoder> CreateSequentialDecoder(
      std::uint8_t type) override {
    if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER)
      return std::make_unique<GuardedAttribute<draco::SequentialIntegerAttributeDecoder>>(most_);
    if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION)
      return std::make_unique<GuardedAttribute<draco::SequentialQuantizationAttributeDecoder>>(
          most_);
    return Controller::CreateSequentialDecoder(type);
  }

 private:
  std::uint32_t most_;
};

// Names a member that the library makes no way to, which an explicit instantiation may do: the
// order of values is made from the connectivity, which the library's own decoder alone knows.
template <auto member>
struct SequencerOf {
  friend std::unique_ptr<draco::PointsSequencer>& sequencer_of(Controller& controller) {
    return controller.*member;
  }
};
std::unique_ptr<draco::PointsSequencer>& sequencer_of(Controller& controller);
template struct SequencerOf<&Controller::sequencer_>;

class GuardedMesh : public draco::MeshEdgebreakerDecoder {
 protected:
  // Puts a guarded decoder in place of the one that the library makes, before it reads anything.
  bool CreateAttributesDecoder(std::int32_t id) override {
    if (!draco::MeshEdgebreakerDecoder::CreateAttributesDecoder(id)) return false;
    auto* made = dynamic_cast<Controller*>(
        const_cast<draco::AttributesDecoderInterface*>(attributes_decoder(id)));
    if (!made) return true;
    const auto corners = static_cast<std::uint32_t>(3 * mesh()->num_faces());
    return SetAttributesDecoder(
        id, std::make_unique<GuardedController>(std::move(sequencer_of(*made)), corners));
  }
};

}  // namespace

bool decode_edgebreaker(draco::DecoderBuffer& buffer, draco::Mesh& mesh) {
  const draco::DecoderOptions options;
  GuardedMesh decoder;
  return static_cast<draco::MeshDecoder&>(decoder).Decode(options, &buffer, &mesh).ok();
}

}  // namespace atlas
