// What the graphics card does with points; VTK fills in the lines that begin with //VTK.
#pragma once

namespace tiltmap::ui {

inline constexpr const char* kPointVertices = R"(//VTK::System::Dec
in vec3 place;
in vec3 colour;
uniform mat4 clipFromScan;
uniform mat4 worldFromScan;
uniform int boxed;
uniform vec3 boxLow;
uniform vec3 boxHigh;
out vec3 shown;
void main() {
  shown = colour;
  gl_Position = clipFromScan * vec4(place, 1.0);
  if (boxed == 1) {
    vec3 world = (worldFromScan * vec4(place, 1.0)).xyz;
    if (any(lessThan(world, boxLow)) || any(greaterThan(world, boxHigh)))
      gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // out of the picture
  }
}
)";

inline constexpr const char* kPointFragments = R"(//VTK::System::Dec
//VTK::Output::Dec
in vec3 shown;
void main() {
  gl_FragData[0] = vec4(shown, 1.0);
}
)";

// The pictures of both sides become one, shaded by depth where that is wanted: a point that lies behind its
// neighbours in the picture gets darker (eye-dome lighting, Boucheny 2009, with the logarithm of the depth).
inline constexpr const char* kMixFragments = R"(//VTK::System::Dec
//VTK::Output::Dec
uniform sampler2D nowColour;
uniform sampler2D nowDepth;
uniform sampler2D beforeColour;
uniform sampler2D beforeDepth;
uniform float divider;
uniform int shaded;
uniform int parallel;
uniform vec2 ends;
uniform int radius;
uniform ivec2 last;
in vec2 texCoord;

float depthAt(ivec2 at, bool before) {
  return before ? texelFetch(beforeDepth, at, 0).r : texelFetch(nowDepth, at, 0).r;
}
float distanceOf(float depth) {
  float d = parallel == 1 ? mix(ends.x, ends.y, depth)
                          : ends.x * ends.y / (ends.y - depth * (ends.y - ends.x));
  return log2(max(d, 1e-4));
}
void main() {
  ivec2 at = min(ivec2(texCoord * vec2(last + 1)), last);
  bool before = float(at.x) + 0.5 < divider;
  float depth = depthAt(at, before);
  if (depth >= 1.0) discard;
  vec3 colour = before ? texelFetch(beforeColour, at, 0).rgb : texelFetch(nowColour, at, 0).rgb;
  if (shaded == 1) {
    float own = distanceOf(depth);
    float behind = 0.0;
    ivec2 steps[8] = ivec2[8](ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1), ivec2(1, 1), ivec2(-1, 1),
                              ivec2(1, -1), ivec2(-1, -1));
    for (int k = 0; k < 8; ++k) {
      float other = depthAt(clamp(at + radius * steps[k], ivec2(0), last), before);
      if (other < 1.0) behind += max(0.0, own - distanceOf(other));
    }
    colour *= max(0.12, exp(-22.0 * behind / 8.0));
  }
  gl_FragData[0] = vec4(colour, 1.0);
  gl_FragDepth = depth;
}
)";

}  // namespace tiltmap::ui
