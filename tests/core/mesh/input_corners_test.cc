#include "core/mesh/input_corners.h"

#include <array>
#include <random>

#include "tests/core/mesh/shapes.h"
#include "tests/core/testing.h"

namespace moduli {
namespace {

using ::testing::Each;

PreparedMesh prepare(const TriangleSoup& soup, bool repair = false,
                     const std::string& component = "", std::optional<double> fill = {}) {
  Context context;
  auto prepared = prepareMesh(context, soup, {{repair, fill}, component});
  EXPECT_OK(prepared);
  return *std::move(prepared);
}

// A corner stands where its input corner stood, and in each input face all three are met or none.
void expectSound(const TriangleSoup& soup, const PreparedMesh& prepared) {
  const std::vector<Index> corners = inputCorners(soup, prepared);
  const Connectivity& mesh = prepared.mesh.connectivity();
  ASSERT_EQ(corners.size(), static_cast<std::size_t>(mesh.halfedgeCount()));
  std::vector<int> met(3 * soup.faces.size(), 0);
  for (Index h = 0; h < mesh.halfedgeCount(); ++h) {
    const Index g = prepared.input_face[h / 3];
    ASSERT_EQ(corners[h] == kNone, g == kNone);
    if (g == kNone) continue;
    ASSERT_EQ(corners[h] / 3, g);
    ++met[corners[h]];
    const Index v = soup.faces[g][corners[h] % 3];
    EXPECT_EQ(soup.vertices[v], prepared.mesh.positions()[mesh.tail(h)]) << "halfedge " << h;
    const Triangle& face = soup.faces[g];
    const bool alike = soup.vertices[face[1]] == soup.vertices[face[2]];
    if (alike && corners[h] % 3 != 0) {
      EXPECT_EQ(prepared.input_vertex[mesh.tail(h)], v) << "halfedge " << h;
    }
  }
  for (std::size_t k = 0; k < met.size(); k += 3) {
    EXPECT_LE(met[k], 1);
    EXPECT_EQ(met[k], met[k + 1]);
    EXPECT_EQ(met[k], met[k + 2]);
  }
}

VertexPlaces placesIn(const TriangleSoup& soup, const PreparedMesh& prepared) {
  return findVertexPlaces(soup, prepared, inputCorners(soup, prepared));
}

// Every face its own three vertices, every third face turned around.
TriangleSoup shredded(const TriangleSoup& soup) {
  TriangleSoup apart;
  for (const Triangle& face : soup.faces) {
    const auto base = static_cast<Index>(apart.vertices.size());
    for (const Index v : face) apart.vertices.push_back(soup.vertices[v]);
    const bool turned = apart.faces.size() % 3 == 1;
    apart.faces.push_back({base, base + (turned ? 2 : 1), base + (turned ? 1 : 2)});
  }
  return apart;
}

TEST(InputCorners, ASoundSurfaceHasItsOwn) {
  const TriangleSoup soup = shapes::torusGrid(6, 4);
  const PreparedMesh prepared = prepare(soup);
  const std::vector<Index> corners = inputCorners(soup, prepared);
  for (Index h = 0; h < static_cast<Index>(corners.size()); ++h) EXPECT_EQ(corners[h], h);
  const VertexPlaces places = placesIn(soup, prepared);
  for (Index v = 0; v < static_cast<Index>(places.place.size()); ++v) {
    EXPECT_EQ(places.place[v], v);
  }
  EXPECT_THAT(places.used, Each(true));
}

TEST(InputCorners, FollowWeldedAndTurnedFaces) {
  const TriangleSoup soup = shredded(shapes::icosahedron());
  const PreparedMesh prepared = prepare(soup, true);
  ASSERT_EQ(prepared.mesh.vertexCount(), 12);
  expectSound(soup, prepared);
  const VertexPlaces places = placesIn(soup, prepared);
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    ASSERT_GE(places.place[v], 0) << "a welded vertex has the place of all of them";
    EXPECT_EQ(prepared.mesh.positions()[places.place[v]], soup.vertices[v]);
  }
}

TEST(InputCorners, FollowATurnedFaceWhoseCornersAreInOnePlace) {
  // Welding an edge of so small a torus would make edges of four faces: its ends stay apart.
  TriangleSoup soup = shapes::torusGrid(3, 3);
  Triangle& face = soup.faces[4];
  soup.vertices[face[2]] = Eigen::Vector3d(soup.vertices[face[1]]);
  std::swap(face[1], face[2]);
  const PreparedMesh prepared = prepare(soup, true);
  ASSERT_EQ(prepared.mesh.vertexCount(), 9);
  ASSERT_NE(prepared.mesh.connectivity().face(4), face) << "was not turned";
  expectSound(soup, prepared);
}

TEST(InputCorners, FollowPinchedVertices) {
  const TriangleSoup soup = shapes::bowTie();
  const PreparedMesh prepared = prepare(soup, true, "1");
  expectSound(soup, prepared);
  const VertexPlaces places = placesIn(soup, prepared);
  EXPECT_THAT(places.place[0], testing::Ge(0)) << "one fan alone is in this component";
  EXPECT_EQ(places.place[1], kNone);
  EXPECT_TRUE(places.used[1]);
}

TEST(InputCorners, AVertexThatIsSplitWithinASurfaceHasNoOnePlace) {
  const auto outside = [](Index i) { return i < 1 || i > 3; };
  TriangleSoup pinched =
      shapes::plate(5, 5, [&](Index i, Index j) { return outside(i) || outside(j); });
  // The inner loop's opposite corners become one vertex.
  Index a = kNone, b = kNone;
  for (Index v = 0; v < static_cast<Index>(pinched.vertices.size()); ++v) {
    if (pinched.vertices[v] == Eigen::Vector3d(1, 1, 0)) a = v;
    if (pinched.vertices[v] == Eigen::Vector3d(4, 4, 0)) b = v;
  }
  for (Triangle& face : pinched.faces) {
    for (Index& v : face) v = v == b ? a : v;
  }
  const PreparedMesh prepared = prepare(pinched, true);
  expectSound(pinched, prepared);
  const VertexPlaces places = placesIn(pinched, prepared);
  EXPECT_EQ(places.place[a], VertexPlaces::kSeveral);
  EXPECT_EQ(places.place[b], kNone);
  EXPECT_FALSE(places.used[b]);
}

TEST(InputCorners, FacesThatFillHolesHaveNone) {
  const TriangleSoup soup = shapes::annulus();
  const PreparedMesh prepared = prepare(soup, false, "", 1.5);
  ASSERT_GT(prepared.mesh.faceCount(), static_cast<Index>(soup.faces.size()));
  expectSound(soup, prepared);
}

TEST(InputCorners, AreSoundOnRandomDamage) {
  std::mt19937 random(5);
  for (int round = 0; round < 500; ++round) {
    TriangleSoup soup = shapes::together(shapes::torusGrid(5, 4), shapes::disk());
    if (round % 2 == 0) soup = shredded(soup);
    for (int damage = 0; damage < 6; ++damage) {
      Triangle& face = soup.faces[random() % soup.faces.size()];
      switch (random() % 3) {
        case 0:
          std::swap(face[random() % 3], face[random() % 3]);
          break;
        case 1:
          soup.faces.push_back(Triangle(face));
          break;
        default:
          soup.vertices[face[0]] = Eigen::Vector3d(soup.vertices[face[1]]);
      }
    }
    Context context;
    const auto prepared = prepareMesh(context, soup, {{true, {}}, "largest"});
    if (prepared.ok()) expectSound(soup, *prepared);
  }
}

}  // namespace
}  // namespace moduli
