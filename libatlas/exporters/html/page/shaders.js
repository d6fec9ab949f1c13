// The programs of the graphics processor. One draws the surface in every view.

const kViews = {light: 0, charts: 1, pages: 2, error: 3, falseColours: 4};
const kTones = {linear: 0, reinhard: 1, drago: 2, 'reinhard-devlin': 3};
const kMostLevels = 16;  // isolines

const kVertexShader = `#version 300 es
precision highp float;
in vec3 position;
in vec2 uv;
in uint chart;
in vec3 reflectance;
uniform vec3 eye;
uniform mat4 camera;
out vec3 place;
out vec2 texel;
flat out uint ofChart;
flat out vec3 ofReflectance;
void main() {
  place = position - eye;
  texel = uv;
  ofChart = chart;
  ofReflectance = reflectance;
  gl_Position = camera * vec4(place, 1.0);
}`;

// A palette that runs evenly from dark to bright for the error, and one of many hues, dark blue to
// dark red, for light: it separates neighbouring levels (the polynomial of Mikhailov's Turbo).
const kPalettes = `
vec3 turbo(float x) {
  vec4 v4 = vec4(1.0, x, x * x, x * x * x);
  vec2 v2 = v4.zw * v4.z;
  return clamp(vec3(
    dot(v4, vec4(0.13572138, 4.61539260, -42.66032258, 132.13108234)) +
      dot(v2, vec2(-152.94239396, 59.28637943)),
    dot(v4, vec4(0.09140261, 2.19418839, 4.84296658, -14.18503333)) +
      dot(v2, vec2(4.27729857, 2.82956604)),
    dot(v4, vec4(0.10667330, 12.64194608, -60.58204836, 110.36276771)) +
      dot(v2, vec2(-89.90310912, 27.34824973))), 0.0, 1.0);
}
vec3 heat(float x) {
  return mix(mix(vec3(0.10, 0.12, 0.22), vec3(0.55, 0.16, 0.42), clamp(2.0 * x, 0.0, 1.0)),
             mix(vec3(0.95, 0.42, 0.22), vec3(1.0, 0.95, 0.70), clamp(2.0 * x - 1.0, 0.0, 1.0)),
             smoothstep(0.25, 0.75, x));
}`;

// The curves of texture/tone.cpp.
const kToneCurves = `
uniform int tone;
uniform float toneScale, toneWhite;
uniform vec4 toneParameter;
uniform vec3 toneOffset;
float luma(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }
vec3 toneMapped(vec3 light) {
  vec3 c = min(toneScale * max(light, 0.0), 1e18);
  if (tone == 0) return min(c, 1.0);
  float y = luma(c);
  if (!(y > 0.0)) return vec3(0.0);
  if (tone == 3) {
    vec3 local = toneParameter.z * c + (1.0 - toneParameter.z) * y;
    vec3 adapted = toneParameter.y * local + (1.0 - toneParameter.y) * toneOffset;
    return min(toneParameter.w * c / (c + pow(adapted, vec3(toneParameter.x))), 1.0);
  }
  float ratio;
  if (tone == 1) ratio = (1.0 + y / (toneWhite * toneWhite)) / (1.0 + y);
  else ratio = toneParameter.y * log(1.0 + y) /
    (y * log(2.0 + 8.0 * pow(y / toneWhite, toneParameter.x)));
  return min(ratio * c, 1.0);
}
vec3 encoded(vec3 c) {
  return mix(12.92 * c, 1.055 * pow(max(c, 1e-6), vec3(1.0 / 2.4)) - 0.055,
             greaterThan(c, vec3(0.0031308)));
}`;

const kFragmentShader = `#version 300 es
precision highp float;
precision highp int;
in vec3 place;
in vec2 texel;
flat in uint ofChart;
flat in vec3 ofReflectance;
uniform int view;
uniform bool lit;         // the page has an image, and it is there
uniform bool holdsLight;  // the image holds light, not display values
uniform sampler2D page;
uniform float pageScale;
uniform int pageNumber;
uniform sampler2D error;
uniform float errorRange;  // of which the palette's end stands; 0: not measured
uniform bool illuminance;  // false colours are divided by the reflectance
uniform float valueScale;
uniform float levels[${kMostLevels}];
uniform int levelCount;
uniform bool isolines;
uniform float low, high;   // of the palette
uniform bool logarithmic;
out vec4 colour;
${kPalettes}${kToneCurves}
vec3 hue(uint id) {
  uint h = (id + 1u) * 2654435769u;
  float a = float(h >> 8) / 16777216.0, b = float((h * 2246822519u) >> 8) / 16777216.0;
  vec3 c = 0.5 + 0.5 * cos(6.2831853 * (a + vec3(0.0, 0.33, 0.67)));
  return mix(vec3(0.62), c, 0.55) * (0.75 + 0.35 * b);
}
float facing() {
  vec3 n = normalize(cross(dFdx(place), dFdy(place)));
  return abs(dot(n, normalize(place)));
}
float paletteAt(float v) {
  float x = logarithmic ? log(max(v, 1e-20) / low) / log(high / low) : (v - low) / (high - low);
  return clamp(x, 0.0, 1.0);
}
vec3 falseColour(vec3 light) {
  float v = luma(light) * valueScale;
  if (illuminance) {
    if (min(min(ofReflectance.r, ofReflectance.g), ofReflectance.b) <= 0.0) {
      float stripe = step(0.5, fract((gl_FragCoord.x + gl_FragCoord.y) / 14.0));
      return mix(vec3(0.30), vec3(0.36), stripe);
    }
    v = luma(light / ofReflectance) * valueScale;
  }
  vec3 c = turbo(0.02 + 0.96 * paletteAt(v));
  if (!isolines) return c;
  float width = fwidth(v);
  for (int i = 0; i < levelCount; ++i)
    if (abs(v - levels[i]) < 0.75 * width) return c * 0.22;
  return c;
}
vec3 shown() {
  vec3 looked = texture(page, texel).rgb;
  if (view == 4 && holdsLight && lit) return falseColour(looked * pageScale);
  float shade = 0.35 + 0.65 * facing();
  if (view == 1) return hue(ofChart) * shade;
  if (view == 2) return hue(uint(pageNumber) + 7u) * shade;
  if (view == 3 && errorRange > 0.0) {
    float e = texture(error, texel).r;
    return e < 0.0 ? vec3(0.25) * shade : heat(min(e / errorRange, 1.0)) * (0.7 + 0.3 * shade);
  }
  if (!lit) return vec3(0.72, 0.73, 0.75) * shade;
  return holdsLight ? encoded(toneMapped(looked * pageScale)) : looked;
}
void main() { colour = vec4(shown(), 1.0); }`;
