// Pages that hold the light itself, see html/light_page.h. The function also runs in a Worker, so it
// uses nothing outside of itself.
function lightTools() {
  const kTopOctave = 11;  // of what shared exponents hold (up to 65408), with room for pure blue

  // Takes back the predictions from the lower rows on.
  function restored(values, width, mask) {
    for (let i = 0; i < values.length; ++i) {
      const left = i % width ? values[i - 1] : 0, lower = i >= width ? values[i - width] : 0;
      const corner = i % width && i >= width ? values[i - width - 1] : 0;
      const p = left + lower - corner;
      const a = Math.abs(p - left), b = Math.abs(p - lower), c = Math.abs(p - corner);
      values[i] = (values[i] + (a <= b && a <= c ? left : b <= c ? lower : corner)) & mask;
    }
    return values;
  }

  function decode(bytes) {
    const head = new DataView(bytes.buffer, bytes.byteOffset, 12);
    const width = head.getUint32(0, true), height = head.getUint32(4, true);
    const count = width * height, planes = bytes.subarray(12);
    const codes = new Uint16Array(count);
    for (let i = 0; i < count; ++i) {
      const folded = planes[i] | (planes[count + i] << 8);
      codes[i] = (folded >>> 1) ^ -(folded & 1);
    }
    return {
      width, height, top: head.getFloat32(8, true),
      codes: restored(codes, width, 65535),
      red: restored(planes.slice(2 * count, 3 * count), width, 255),
      blue: restored(planes.slice(3 * count, 4 * count), width, 255),
    };
  }

  // The luma of each code, times 2^(kTopOctave - top).
  function lumas() {
    const table = new Float32Array(65536);
    for (let c = 1; c < 65536; ++c) table[c] = 2 ** (kTopOctave + (c - 65535) / 256);
    return table;
  }

  const bits = new Float32Array(1), asWord = new Uint32Array(bits.buffer);
  const units = Float32Array.from({length: 33}, (_, exponent) => 2 ** (24 - exponent));
  // The format RGB9_E5 of OpenGL, which rounds each channel to a 512th of the largest or finer.
  function shared(r, g, b) {
    bits[0] = Math.max(r, g, b, 2 ** -16);
    let exponent = (asWord[0] >>> 23) - 127 + 16;
    if (bits[0] * units[exponent] >= 511.5) ++exponent;
    const n = units[exponent];
    return (exponent << 27) | ((b * n + 0.5) << 18) | ((g * n + 0.5) << 9) | (r * n + 0.5);
  }

  function colours({codes, red, blue}) {
    const table = lumas(), rgb = new Float32Array(3 * codes.length);
    for (let i = 0; i < codes.length; ++i) {
      if (codes[i] === 0) continue;
      const r = red[i] / 255, b = blue[i] / 255, g = Math.max(0, 1 - r - b);
      const sum = table[codes[i]] / (0.2126 * r + 0.7152 * g + 0.0722 * b);
      rgb[3 * i] = r * sum;
      rgb[3 * i + 1] = g * sum;
      rgb[3 * i + 2] = b * sum;
    }
    return rgb;
  }

  function packed(rgb) {
    const texels = new Uint32Array(rgb.length / 3);
    for (let i = 0; i < texels.length; ++i)
      texels[i] = shared(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]);
    return texels;
  }

  function halved(rgb, width, height) {
    const w = Math.max(1, width >> 1), h = Math.max(1, height >> 1);
    const half = new Float32Array(3 * w * h);
    const right = width > 1 ? 3 : 0, up = height > 1 ? 3 * width : 0;
    for (let y = 0; y < h; ++y)
      for (let x = 0; x < w; ++x)
        for (let k = 0; k < 3; ++k) {
          const at = 3 * (2 * y * width * (height > 1 ? 1 : 0) + (width > 1 ? 2 * x : x)) + k;
          half[3 * (y * w + x) + k] =
            (rgb[at] + rgb[at + right] + rgb[at + up] + rgb[at + right + up]) / 4;
        }
    return half;
  }

  // Returns the page with its levels of detail for the graphics processor, whose values times
  // `scale` are light.
  function unpack(bytes) {
    const page = decode(bytes);
    page.levels = [];
    let rgb = colours(page), {width, height} = page;
    for (;;) {
      page.levels.push(packed(rgb));
      if (width === 1 && height === 1) break;
      rgb = halved(rgb, width, height);
      width = Math.max(1, width >> 1);
      height = Math.max(1, height >> 1);
    }
    page.scale = 2 ** (page.top - kTopOctave);
    return page;
  }

  return {unpack};
}

// Returns the light of a texel, RGB.
function lightOfTexel(page, x, y) {
  const i = clamp(y, 0, page.height - 1) * page.width + clamp(x, 0, page.width - 1);
  if (page.codes[i] === 0) return [0, 0, 0];
  const r = page.red[i] / 255, b = page.blue[i] / 255, g = Math.max(0, 1 - r - b);
  const sum = 2 ** (page.top + (page.codes[i] - 65535) / 256) / luma(r, g, b);
  return [r * sum, g * sum, b * sum];
}

// Returns the light at a place on the page, which is interpolated as the picture is.
function lightAt(page, u, v) {
  const x = u * page.width - 0.5, y = v * page.height - 0.5;
  const x0 = Math.floor(x), y0 = Math.floor(y), s = x - x0, t = y - y0;
  const lower = [lightOfTexel(page, x0, y0), lightOfTexel(page, x0 + 1, y0)];
  const upper = [lightOfTexel(page, x0, y0 + 1), lightOfTexel(page, x0 + 1, y0 + 1)];
  return [0, 1, 2].map((k) => (1 - t) * ((1 - s) * lower[0][k] + s * lower[1][k]) +
    t * ((1 - s) * upper[0][k] + s * upper[1][k]));
}

// The quantities that false colours and values can show: how light becomes a number.
function quantitiesOf(world) {
  if (!world.light) return [];
  const luminance = {
    name: 'luminance', unit: 'cd/m²', text: 'Luminance',
    scale: world.light.quantity === 'illuminance' ? 1 / Math.PI : 1,
  };
  if (world.light.quantity === 'illuminance')
    return [{name: 'illuminance', unit: 'lx', text: 'Illuminance', scale: 1, illuminance: true},
      luminance];
  if (world.light.quantity === 'colour') return [{...luminance, unit: '', text: 'Colour'}];
  return [luminance, {...luminance, name: 'illuminance', unit: 'lx', text: 'Illuminance'}];
}

// Returns the value of light as this quantity, or null where a texture hides the reflectance.
function valueOf(quantity, light, reflectance) {
  if (!quantity.illuminance) return luma(...light) * quantity.scale;
  if (!reflectance || Math.min(...reflectance) <= 0) return null;
  return luma(...light.map((v, k) => v / reflectance[k])) * quantity.scale;
}

// Returns round numbers within [low, high]: 1, 2, 5 in each decade, or even steps.
function levelsWithin(low, high, logarithmic) {
  const levels = [];
  if (logarithmic) {
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); ++e)
      for (const m of [1, 2, 5]) levels.push(m * 10 ** e);
  } else {
    const rough = (high - low) / 8, ten = 10 ** Math.floor(Math.log10(rough));
    const step = ten * [1, 2, 5, 10].find((m) => m * ten >= rough);
    for (let i = Math.ceil(low / step); i * step <= high * 1.0001; ++i) levels.push(i * step);
  }
  const within = levels.filter((v) => v >= low * 0.9999 && v <= high * 1.0001);
  return within.length > kMostLevels ? within.filter((_, i) => i % 3 === 0) : within;
}

// Returns a number with three digits that count.
function shortNumber(value) {
  if (value === 0) return '0';
  const digits = clamp(2 - Math.floor(Math.log10(Math.abs(value))), 0, 12);
  return Number(value.toPrecision(3)).toLocaleString('en', {maximumFractionDigits: digits})
    .replace(/,/g, '\u202f');
}
