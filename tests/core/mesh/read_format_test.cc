#include <filesystem>
#include <fstream>

#include "core/mesh/deflate.h"
#include "tests/core/mesh/read_helpers.h"

namespace moduli {
namespace {

TEST(Format, NamesGoThereAndBack) {
  for (const auto format :
       {MeshFormat::kObj, MeshFormat::kOff, MeshFormat::kPly, MeshFormat::kStl}) {
    EXPECT_EQ(formatFromName(formatName(format)), format);
    EXPECT_EQ(formatFromExtension("a.b/x." + std::string(formatName(format))), format);
  }
  for (const auto format : {MeshFormat::kGifti, MeshFormat::kFreeSurfer}) {
    EXPECT_EQ(formatFromName(formatName(format)), format);
  }
  EXPECT_EQ(formatFromName("GII"), MeshFormat::kGifti);
  EXPECT_EQ(formatFromName(".PLY"), MeshFormat::kPly);
  EXPECT_EQ(formatFromExtension("X.OBJ"), MeshFormat::kObj);
  EXPECT_EQ(formatFromExtension("obj"), std::nullopt);
  EXPECT_EQ(formatFromName("3ds"), std::nullopt);
}

TEST(Format, BrainSurfacesAreKnownByTheirNames) {
  for (const std::string name : {"a.gii", "lh.pial.gii", "a.surf.gii", "A.SURF.GII", "a.gii.gz"}) {
    EXPECT_EQ(formatFromExtension(name), MeshFormat::kGifti) << name;
  }
  for (const std::string name :
       {"lh.pial", "rh.white", "lh.inflated", "lh.sphere", "x/lh.smoothwm"}) {
    EXPECT_EQ(formatFromExtension(name), MeshFormat::kFreeSurfer) << name;
  }
  for (const std::string name :
       {"a.shape.gii", "a.func.gii", "a.label.gii.gz", "a.nii.gz", "a.gz", "lh.sulc", "gii"}) {
    EXPECT_EQ(formatFromExtension(name), std::nullopt) << name;
  }
}

TEST(Format, BrainSurfacesAreKnownByTheirContent) {
  const std::string xml = "<?xml version=\"1.0\"?>\n<!DOCTYPE GIFTI>\n<GIFTI>";
  for (const std::string name : {"x.obj", "x.stl", "x"}) {
    EXPECT_EQ(detectFormat(xml, name), MeshFormat::kGifti);
    EXPECT_EQ(detectFormat("\xEF\xBB\xBF \n" + xml, name), MeshFormat::kGifti);
    EXPECT_EQ(detectFormat(gzipBytes(xml), name), MeshFormat::kGifti);
    EXPECT_EQ(detectFormat("\xFF\xFF\xFE", name), MeshFormat::kFreeSurfer);
  }
  EXPECT_EQ(detectFormat("<svg>GIF</svg>", "x"), std::nullopt);
  EXPECT_EQ(detectFormat(gzipBytes("v 0 0 0\n"), "x.obj"), std::nullopt);
  EXPECT_EQ(detectFormat("v 0 0 0\n", "lh.pial"), MeshFormat::kObj);
  EXPECT_EQ(detectFormat("nothing", "lh.pial"), std::nullopt);
}

TEST(Format, ContentDecidesBeforeTheName) {
  EXPECT_EQ(detectFormat("OFF\n3 1 0\n", "x.obj"), MeshFormat::kOff);
  EXPECT_EQ(detectFormat("# hi\nSTCN4nOFF\n", "x.obj"), MeshFormat::kOff);
  EXPECT_EQ(detectFormat("ply\nformat", "x.stl"), MeshFormat::kPly);
  EXPECT_EQ(detectFormat("solid x\nfacet", "x.off"), MeshFormat::kStl);
  EXPECT_EQ(detectFormat("# hi\n\nmtllib a\nv 0 0 0\n", "x.off"), MeshFormat::kObj);
  EXPECT_EQ(detectFormat("\xEF\xBB\xBFv 0 0 0\n", ""), MeshFormat::kObj);
}

TEST(Format, TheNameDecidesWhereTheContentDoesNot) {
  EXPECT_EQ(detectFormat("# only a comment", "x.obj"), MeshFormat::kObj);
  EXPECT_EQ(detectFormat("3 1 0\n0 0 0\n", "x.off"), MeshFormat::kOff);
  EXPECT_EQ(detectFormat(std::string(200, '\0'), "x.stl"), MeshFormat::kStl);
  EXPECT_EQ(detectFormat("3 1 0\n0 0 0\n", "x"), std::nullopt);
}

TEST(Format, ANameDoesNotTurnAnyBytesIntoAMesh) {
  const std::string noise(
      "\x7f"
      "ELF\2\1\1\0\0\0",
      10);
  for (const std::string name : {"x.obj", "x.off", "x.ply", "x", "x.3ds"}) {
    EXPECT_THAT(parse(noise, name), FailsAt(Reason::kUnknownFormat, name + ": byte 0: "));
  }
}

TEST(Read, AnEmptyFileIsEmptyWhateverItsName) {
  for (const std::string name : {"x.obj", "x.ply", "x.stl", "x"}) {
    EXPECT_THAT(parse("", name), FailsAt(Reason::kEmpty, name + ": byte 0: the file is empty"));
  }
}

TEST(Read, AFormatThatIsAskedForIsNotGuessed) {
  Context context;
  ReadOptions options;
  options.name = "x.obj";
  options.format = MeshFormat::kOff;
  EXPECT_THAT(readMesh(context, "v 0 0 0\n", options),
              FailsAt(Reason::kSyntaxError, "x.obj:1: 'v'"));
  options.format = MeshFormat::kPly;
  EXPECT_THAT(readMesh(context, "v 0 0 0\n", options),
              FailsAt(Reason::kSyntaxError, "x.obj:1: 'v'"));
}

TEST(Read, MoreFacesThanAllowedAreRefusedInEveryFormat) {
  const std::string stl_facet =
      "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n";
  std::string binary_stl(84 + 100, '\0');
  binary_stl[80] = 2;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\n";
  const std::string list =
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 0 0 0 0 0 0 0\n";
  Context context;
  ReadOptions options;
  options.max_faces = 1;
  for (const std::string& text : {std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\n"),
                                  std::string("OFF 4 1 0\n0 0 0 1 0 0 0 1 0 1 1 0\n4 0 1 2 3\n"),
                                  std::string("OFF 3 2 0\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n3 0 1 2\n"),
                                  "solid\n" + stl_facet + stl_facet + "endsolid\n", binary_stl,
                                  ply + "element face 1\n" + list + "4 0 1 2 3\n",
                                  ply + "element face 2\n" + list + "3 0 1 2 3 0 1 2\n"}) {
    EXPECT_THAT(readMesh(context, text, options), FailsWith(Reason::kMeshTooLarge)) << text;
    options.max_faces = 2;
    EXPECT_OK(readMesh(context, text, options)) << text;
    options.max_faces = 1;
  }
}

TEST(Read, ACancelledCallerGetsNoMesh) {
  Context context;
  CancelToken token;
  context.setCancelToken(token);
  token.cancel();
  EXPECT_THAT(readMesh(context, "v 0 0 0\n", {}), FailsWith(Reason::kCancelled));
}

TEST(ReadFile, NamesThePathAndWhyItCannotBeRead) {
  Context context;
  EXPECT_THAT(readMeshFile(context, "/nowhere/x.obj"),
              FailsAt(Reason::kFileNotFound, "/nowhere/x.obj: "));
  EXPECT_THAT(readMeshFile(context, "/tmp"), FailsAt(Reason::kFileUnreadable, "/tmp: "));
  const std::string path = testing::TempDir() + "moduli_read_test.off";
  std::ofstream(path) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n";
  EXPECT_THAT(readMeshFile(context, path), FailsAt(Reason::kIndexOutOfRange, path + ":6: "));
  ReadOptions options;
  options.name = "short.off";
  EXPECT_THAT(readMeshFile(context, path, options),
              FailsAt(Reason::kIndexOutOfRange, "short.off:6: "));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace moduli
