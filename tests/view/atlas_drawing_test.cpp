// Draws atlases with the graphics driver, as programs that render light into them do: no texel is
// drawn twice, as the library counts itself, and charts cover the area that the library says.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "libatlas/unwrap/unwrap.h"
#include "libatlas/view/gl_objects.h"
#include "tests/support/shapes.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

constexpr const char* kVertex = R"(#version 450 core
layout(location = 0) in vec2 uv;
void main() { gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0); }
)";
constexpr const char* kFragment = R"(#version 450 core
out float drawn;
void main() { drawn = 1.0; }
)";

struct Drawn {
  std::uint64_t covered = 0;  // texels
  std::uint64_t again = 0;    // how often texels were drawn that had been drawn before
};

// Draws the triangles of one page of a mesh, and adds 1 to every texel that a triangle covers.
Drawn draw_page(const UnwrappedMesh& mesh, std::uint32_t page, GLuint program) {
  std::vector<std::uint32_t> indices;
  for (std::size_t t = 0; t < mesh.triangle_page.size(); ++t)
    if (mesh.triangle_page[t] == page)
      indices.insert(indices.end(), mesh.indices.begin() + 3 * std::ptrdiff_t(t),
                     mesh.indices.begin() + 3 * std::ptrdiff_t(t) + 3);
  const Extent size = mesh.pages[page];
  const GlTexture target = make_texture(GL_R32F, size.width, size.height);
  const GlFramebuffer framebuffer = create<GlFramebuffer>(glCreateFramebuffers);
  glNamedFramebufferTexture(framebuffer.get(), GL_COLOR_ATTACHMENT0, target.get(), 0);
  const GlBuffer uvs = make_buffer(mesh.uvs.data(), mesh.uvs.size() * sizeof(Vec2f));
  const GlBuffer corners = make_buffer(indices.data(), indices.size() * sizeof(std::uint32_t));
  const GlVertexArray array = create<GlVertexArray>(glCreateVertexArrays);
  glVertexArrayVertexBuffer(array.get(), 0, uvs.get(), 0, sizeof(Vec2f));
  glVertexArrayAttribFormat(array.get(), 0, 2, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(array.get(), 0, 0);
  glEnableVertexArrayAttrib(array.get(), 0);
  glVertexArrayElementBuffer(array.get(), corners.get());

  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
  glViewport(0, 0, size.width, size.height);
  const float none = 0;
  glClearNamedFramebufferfv(framebuffer.get(), GL_COLOR, 0, &none);
  for (const GLenum off : {GL_CULL_FACE, GL_DEPTH_TEST, GL_SCISSOR_TEST}) glDisable(off);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glUseProgram(program);
  glBindVertexArray(array.get());
  glDrawElements(GL_TRIANGLES, GLsizei(indices.size()), GL_UNSIGNED_INT, nullptr);
  glDisable(GL_BLEND);

  std::vector<float> texels(std::size_t(size.width) * std::size_t(size.height));
  glGetTextureImage(target.get(), 0, GL_RED, GL_FLOAT, GLsizei(texels.size() * sizeof(float)),
                    texels.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  Drawn drawn;
  for (const float times : texels) {
    drawn.covered += times > 0;
    drawn.again += std::uint64_t(std::max(times - 1, 0.0f));
  }
  return drawn;
}

Drawn draw_atlas(const UnwrappedMesh& mesh) {
  test_context();
  const Result<GlProgram> program = link_program("atlas", kVertex, kFragment);
  EXPECT_TRUE(program.ok()) << program.status().message();
  Drawn all;
  for (std::uint32_t p = 0; p < mesh.pages.size(); ++p) {
    const Drawn drawn = draw_page(mesh, p, program->get());
    all.covered += drawn.covered;
    all.again += drawn.again;
  }
  EXPECT_TRUE(check_gl("drawing an atlas").ok());
  return all;
}

UnwrappedMesh unwrapped(const test::Shape& shape, std::int32_t page_size) {
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  const UnwrapOptions options{
      {.pages = 2, .page_size = page_size, .square = true, .preset = PackPreset::fast}};
  Result<UnwrappedMesh> mesh = unwrap_mesh(view, options, {});
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return std::move(mesh.value());
}

TEST(AtlasDrawing, NoTexelIsDrawnTwice) {
  for (const std::int32_t page_size : {256, 512})
    for (const test::Shape& shape : {test::noisy_along_normals(test::icosphere(3), 0.2),
                                     test::torus(48, 20), test::plate_with_holes(3, 6),
                                     test::soup(250, 3), test::fan(2500), test::sphere(800, 8)}) {
      SCOPED_TRACE(::testing::Message() << shape.name << " on pages of " << page_size);
      const UnwrappedMesh mesh = unwrapped(shape, page_size);
      const Drawn drawn = draw_atlas(mesh);
      double area = 0;
      for (const Extent& page : mesh.pages) area += double(page.width) * double(page.height);
      EXPECT_EQ(drawn.again, mesh.texels_drawn_twice);
      EXPECT_EQ(drawn.again, 0u);
      EXPECT_NEAR(double(drawn.covered) / area, mesh.utilization, 0.005);
    }
}

TEST(AtlasDrawing, ATriangleThatLiesOverOthersIsSeen) {
  UnwrappedMesh mesh = unwrapped(test::torus(24, 10), 256);
  const Drawn once = draw_atlas(mesh);
  const std::vector<std::uint32_t> first(mesh.indices.begin(), mesh.indices.begin() + 3);
  mesh.indices.insert(mesh.indices.end(), first.begin(), first.end());
  mesh.triangle_page.push_back(mesh.triangle_page[0]);
  const Drawn twice = draw_atlas(mesh);
  EXPECT_EQ(twice.covered, once.covered);
  EXPECT_GT(twice.again, 10u);
}

}  // namespace
}  // namespace atlas::testing
