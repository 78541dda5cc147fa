#include "client/cli/textured_obj.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <vector>

namespace moduli::cli {
namespace {

constexpr std::size_t kPiece = 1 << 20;

/// Text on its way to the sink.
class Lines {
 public:
  explicit Lines(const std::function<Status(std::string_view)>& sink) : sink_(sink) {}

  template <typename Number>
  void number(Number value) {
    std::array<char, 32> buffer;
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    text_.append(buffer.data(), end);
  }
  void word(std::string_view text) { text_ += text; }

  /// Ends a line.
  Status end() {
    text_ += '\n';
    return text_.size() < kPiece ? Status() : flush();
  }
  Status flush() {
    const Status status = sink_(text_);
    text_.clear();
    return status;
  }

 private:
  const std::function<Status(std::string_view)>& sink_;
  std::string text_;
};

// "v x y z" for each `columns` numbers.
Status writeRows(Lines& lines, std::string_view keyword, const std::vector<double>& numbers,
                 std::size_t columns) {
  for (std::size_t i = 0; i < numbers.size(); i += columns) {
    lines.word(keyword);
    for (std::size_t k = 0; k < columns; ++k) {
      lines.word(" ");
      lines.number(numbers[i + k]);
    }
    RETURN_IF_ERROR(lines.end());
  }
  return {};
}

constexpr const char* kCheckerMaterial = "moduli_checker";
constexpr const char* kPlainMaterial = "moduli_plain";

/// The faces of a file with what belongs to them.
class FaceWriter {
 public:
  FaceWriter(const ParameterizedMesh& mesh, const TexturedObjOptions& options, Lines& lines)
      : mesh_(mesh), textured_(!options.materials.empty()), lines_(lines) {
    const std::size_t faces = mesh.faces.size() / 3;
    const std::size_t given = countGiven();
    if (options.kept != nullptr && options.kept->texture.size() == given) kept_ = options.kept;
    if (kept_ == nullptr) return;
    pieces_.assign(given, 0);
    for (std::size_t f = 0; f < faces; ++f) ++pieces_[parent(f)];
    findKeptRows();
  }

  /// The old texture points and normals that faces still have.
  Status writeRows() {
    if (kept_ == nullptr) return {};
    RETURN_IF_ERROR(writeTexts("vt ", kept_->texture_points, texture_row_));
    return writeTexts("vn ", kept_->normals, normal_row_);
  }

  Status writeFaces() {
    for (std::size_t f = 0; f < mesh_.faces.size() / 3; ++f) {
      if (kept_ != nullptr) RETURN_IF_ERROR(writeStatements(parent(f)));
      if (textured_) RETURN_IF_ERROR(writeMaterial(f));
      RETURN_IF_ERROR(writeFace(f));
    }
    return {};
  }

 private:
  using Rows = std::vector<std::int64_t>;  ///< Per row of the old file one of the new, from 1; 0.

  // Faces of the input; 0 where that is not known.
  std::size_t countGiven() const {
    if (!mesh_.parents.empty()) return static_cast<std::size_t>(mesh_.parents.back()) + 1;
    return mesh_.result.refined() ? 0 : mesh_.faces.size() / 3;
  }
  std::size_t parent(std::size_t f) const {
    return mesh_.parents.empty() ? f : static_cast<std::size_t>(mesh_.parents[f]);
  }
  bool isMapped(std::size_t f) const { return mesh_.corners[3 * f] >= 0; }

  const Triangle* texture(std::size_t f) const {
    if (kept_ == nullptr || isMapped(f) || pieces_[parent(f)] != 1) return nullptr;
    const Triangle& rows = kept_->texture[parent(f)];
    return rows[0] == kNone ? nullptr : &rows;
  }
  const Triangle* normal(std::size_t f) const {
    const bool moved = mesh_.result.target() == v1::ParameterizationOptions::SPHERE;
    if (kept_ == nullptr || moved || pieces_[parent(f)] != 1) return nullptr;
    const Triangle& rows = kept_->normal[parent(f)];
    return rows[0] == kNone ? nullptr : &rows;
  }

  void findKeptRows() {
    texture_row_.assign(kept_->texture_points.size(), 0);
    normal_row_.assign(kept_->normals.size(), 0);
    const auto mark = [](Rows& rows, const Triangle* used) {
      if (used == nullptr) return;
      for (const Index i : *used) rows[static_cast<std::size_t>(i)] = 1;
    };
    for (std::size_t f = 0; f < mesh_.faces.size() / 3; ++f) {
      mark(texture_row_, texture(f));
      mark(normal_row_, normal(f));
    }
    auto next = static_cast<std::int64_t>(mesh_.points.size() / 2);
    for (std::int64_t& row : texture_row_) row = row == 0 ? 0 : ++next;
    next = 0;
    for (std::int64_t& row : normal_row_) row = row == 0 ? 0 : ++next;
  }

  Status writeTexts(std::string_view keyword, const std::vector<std::string>& texts,
                    const Rows& rows) {
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (rows[i] == 0) continue;
      lines_.word(keyword);
      lines_.word(texts[i]);
      RETURN_IF_ERROR(lines_.end());
    }
    return {};
  }

  // Those that begin at a face of the input or before it. With a texture, materials are remembered
  // for faces that are not mapped.
  Status writeStatements(std::size_t given) {
    for (; next_ < kept_->statements.size() &&
           static_cast<std::size_t>(kept_->statements[next_].face) <= given;
         ++next_) {
      const std::string& text = kept_->statements[next_].text;
      if (textured_ && text.starts_with("usemtl")) {
        own_material_ = text;
        continue;
      }
      lines_.word(text);
      RETURN_IF_ERROR(lines_.end());
    }
    return {};
  }

  Status writeMaterial(std::size_t f) {
    std::string wanted = std::string("usemtl ") + (isMapped(f) ? kCheckerMaterial : kPlainMaterial);
    if (!isMapped(f) && !own_material_.empty()) wanted = own_material_;
    if (wanted == material_) return {};
    material_ = wanted;
    lines_.word(material_);
    return lines_.end();
  }

  Status writeFace(std::size_t f) {
    const Triangle *old = texture(f), *normals = normal(f);
    lines_.word("f");
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = 3 * f + c;
      lines_.word(" ");
      lines_.number(mesh_.faces[k] + 1);
      const std::int64_t point = isMapped(f)      ? mesh_.corners[k] + 1
                                 : old != nullptr ? texture_row_[std::size_t((*old)[c])]
                                                  : 0;
      if (point > 0 || normals != nullptr) lines_.word("/");
      if (point > 0) lines_.number(point);
      if (normals == nullptr) continue;
      lines_.word("/");
      lines_.number(normal_row_[std::size_t((*normals)[c])]);
    }
    return lines_.end();
  }

  const ParameterizedMesh& mesh_;
  bool textured_;
  Lines& lines_;
  const ObjStatements* kept_ = nullptr;
  std::vector<int> pieces_;  ///< Per face of the input.
  Rows texture_row_, normal_row_;
  std::size_t next_ = 0;  ///< Of the statements.
  std::string own_material_, material_;
};

}  // namespace

Status writeTexturedObj(const ParameterizedMesh& mesh, const TexturedObjOptions& options,
                        const std::function<Status(std::string_view)>& sink) {
  Lines lines(sink);
  std::vector<double> points = mesh.points;
  if (!options.materials.empty()) {
    for (std::size_t i = 0; i < points.size(); i += 2) {
      points[i] = options.layout.s(points[i]);
      points[i + 1] = options.layout.t(points[i + 1]);
    }
    lines.word("mtllib " + options.materials);
    RETURN_IF_ERROR(lines.end());
  }
  FaceWriter faces(mesh, options, lines);
  RETURN_IF_ERROR(writeRows(lines, "v", mesh.positions, 3));
  RETURN_IF_ERROR(writeRows(lines, "vt", points, 2));
  RETURN_IF_ERROR(faces.writeRows());
  RETURN_IF_ERROR(faces.writeFaces());
  return lines.flush();
}

std::string texturedMaterials(const std::string& texture) {
  const std::string plain = "Ka 0 0 0\nKs 0 0 0\nillum 1\n";
  return std::string("newmtl ") + kCheckerMaterial + "\nKd 1 1 1\n" + plain + "map_Kd " + texture +
         "\n\nnewmtl " + kPlainMaterial + "\nKd 0.8 0.8 0.8\n" + plain;
}

}  // namespace moduli::cli
