#include "core/mesh/write.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>

#include "core/mesh/gifti.h"

namespace moduli {
namespace {

/// Bytes in the making.
class Output {
 public:
  explicit Output(std::size_t expected) { bytes_.reserve(expected); }

  Output& operator<<(std::string_view text) {
    bytes_ += text;
    return *this;
  }
  template <typename Number>
  Output& number(Number value) {
    std::array<char, 32> buffer;
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    bytes_.append(buffer.data(), end);
    return *this;
  }
  /// x y z between blanks.
  Output& point(const Eigen::Vector3d& p) {
    return number(p[0]).blank().number(p[1]).blank().number(p[2]);
  }
  Output& blank() {
    bytes_ += ' ';
    return *this;
  }
  /// Lowest byte first, whatever the machine.
  template <typename Unsigned>
  Output& littleEndian(Unsigned value) {
    std::array<char, sizeof(Unsigned)> buffer;
    for (std::size_t i = 0; i < buffer.size(); ++i) {
      buffer[i] = static_cast<char>(value >> (8 * i) & 0xFFU);
    }
    bytes_.append(buffer.data(), buffer.size());
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// A usual size of a text file; a wrong guess costs a copy, no more.
std::size_t textSize(const TriangleSoup& soup) {
  return 1024 + 60 * soup.vertices.size() + 24 * soup.faces.size();
}

std::string writeObj(const TriangleSoup& soup) {
  Output out(textSize(soup));
  for (const Eigen::Vector3d& p : soup.vertices) (out << "v ").point(p) << "\n";
  for (const Triangle& t : soup.faces) {
    (out << "f ").number(t[0] + 1).blank().number(t[1] + 1).blank().number(t[2] + 1) << "\n";
  }
  return out.take();
}

void writeTextBody(Output& out, const TriangleSoup& soup) {
  for (const Eigen::Vector3d& p : soup.vertices) out.point(p) << "\n";
  for (const Triangle& t : soup.faces) {
    (out << "3 ").number(t[0]).blank().number(t[1]).blank().number(t[2]) << "\n";
  }
}

std::string writeOff(const TriangleSoup& soup) {
  Output out(textSize(soup));
  out << "OFF\n";
  out.number(soup.vertices.size()).blank().number(soup.faces.size()) << " 0\n";
  writeTextBody(out, soup);
  return out.take();
}

std::string writePly(const TriangleSoup& soup, Encoding encoding) {
  const bool text = encoding == Encoding::kText;
  Output out(text ? textSize(soup) : 1024 + 24 * soup.vertices.size() + 13 * soup.faces.size());
  out << "ply\nformat " << (text ? "ascii" : "binary_little_endian") << " 1.0\nelement vertex ";
  out.number(soup.vertices.size())
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face ";
  out.number(soup.faces.size()) << "\nproperty list uchar int vertex_indices\nend_header\n";
  if (text) {
    writeTextBody(out, soup);
    return out.take();
  }
  for (const Eigen::Vector3d& p : soup.vertices) {
    for (const double x : p) out.littleEndian(std::bit_cast<std::uint64_t>(x));
  }
  for (const Triangle& t : soup.faces) {
    out << "\3";
    for (const Index v : t) out.littleEndian(static_cast<std::uint32_t>(v));
  }
  return out.take();
}

// Unit normal by the right hand; zero where the triangle has none. Scaling first keeps the products
// in range.
Eigen::Vector3d unitNormal(const std::array<Eigen::Vector3d, 3>& p) {
  double scale = 0;
  for (const Eigen::Vector3d& q : p) scale = std::max(scale, q.cwiseAbs().maxCoeff());
  if (!(scale > 0) || !std::isfinite(scale)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d u = p[1] / scale - p[0] / scale;
  const Eigen::Vector3d v = p[2] / scale - p[0] / scale;
  const Eigen::Vector3d normal = u.cross(v).stableNormalized();
  return normal.allFinite() ? normal : Eigen::Vector3d::Zero();
}

std::array<Eigen::Vector3d, 3> cornersOf(const TriangleSoup& soup, const Triangle& t) {
  return {soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]};
}

std::string writeTextStl(const TriangleSoup& soup) {
  Output out(1024 + 260 * soup.faces.size());
  out << "solid mesh\n";
  for (const Triangle& t : soup.faces) {
    const auto corners = cornersOf(soup, t);
    const Eigen::Vector3f normal = unitNormal(corners).cast<float>();
    (out << "facet normal ").number(normal[0]).blank().number(normal[1]).blank().number(normal[2]);
    out << "\nouter loop\n";
    for (const Eigen::Vector3d& p : corners) (out << "vertex ").point(p) << "\n";
    out << "endloop\nendfacet\n";
  }
  out << "endsolid mesh\n";
  return out.take();
}

Result<std::string> writeBinaryStl(const TriangleSoup& soup) {
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    for (const double x : soup.vertices[v]) {
      if (!std::isfinite(x) || std::isfinite(static_cast<float>(x))) continue;
      return Status(Reason::kInvalidOption,
                    "vertex " + std::to_string(v) + " lies beyond the range of binary STL",
                    "scale the mesh down, or write PLY, OFF or OBJ");
    }
  }
  Output out(84 + 50 * soup.faces.size());
  std::string header = "binary STL";  // Must not begin with "solid".
  header.resize(80, ' ');
  out << header;
  out.littleEndian(static_cast<std::uint32_t>(soup.faces.size()));
  const auto write = [&out](const Eigen::Vector3d& p) {
    for (const double x : p) {
      out.littleEndian(std::bit_cast<std::uint32_t>(static_cast<float>(x)));
    }
  };
  for (const Triangle& t : soup.faces) {
    // The normal of what is written, so that reading and writing again changes nothing.
    auto corners = cornersOf(soup, t);
    for (Eigen::Vector3d& p : corners) {
      // Not cast<float>().cast<double>(): GCC 12 vectorizes that pair to nothing.
      for (double& x : p) x = static_cast<float>(x);
    }
    write(unitNormal(corners));
    for (const Eigen::Vector3d& p : corners) write(p);
    out.littleEndian(std::uint16_t{0});
  }
  return out.take();
}

}  // namespace

Result<std::string> writeMesh(const TriangleSoup& soup, MeshFormat format, Encoding encoding) {
  const bool text_only = format == MeshFormat::kObj || format == MeshFormat::kOff;
  if (text_only && encoding == Encoding::kBinary) {
    return Status(Reason::kInvalidOption,
                  std::string(formatName(format)) + " files have no binary encoding",
                  "write text, or choose ply or stl");
  }
  switch (format) {
    case MeshFormat::kObj:
      return writeObj(soup);
    case MeshFormat::kOff:
      return writeOff(soup);
    case MeshFormat::kPly:
      return writePly(soup, encoding);
    case MeshFormat::kStl:
      if (encoding == Encoding::kBinary) return writeBinaryStl(soup);
      return writeTextStl(soup);
    case MeshFormat::kGifti: {
      GiftiWriteOptions options;
      options.encoding =
          encoding == Encoding::kBinary ? GiftiEncoding::kGzipBase64 : GiftiEncoding::kAscii;
      return writeGiftiSurface(soup, options);
    }
    case MeshFormat::kFreeSurfer:
      return Status(Reason::kInvalidOption, "surfaces of FreeSurfer are read, not written",
                    "choose gifti, which FreeSurfer reads");
    case MeshFormat::kJson:
      return Status(Reason::kInvalidOption, "json files hold intrinsic triangulations, not meshes",
                    "choose obj, off, ply, stl or gifti");
  }
  return Status(Reason::kInternal, "a mesh format without a writer");
}

}  // namespace moduli
