// The one file that knows cairo: PNG bytes, words on pictures and drawings in outlines.
#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/picture/image.h"
#include "core/picture/shapes.h"
#include "core/picture/sheet.h"

namespace moduli {
namespace {

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct ContextDeleter {
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
using Drawing = std::unique_ptr<cairo_t, ContextDeleter>;

constexpr Color kDark = {26, 26, 26}, kGrey = {102, 102, 102};

Status cairoError(cairo_status_t status) {
  return {Reason::kInternal, std::string("drawing failed: ") + cairo_status_to_string(status)};
}

void copyTo(cairo_surface_t* surface, const Image& image, int x0, int y0) {
  cairo_surface_flush(surface);
  unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < image.height; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(data + std::ptrdiff_t(y + y0) * stride) + x0;
    for (int x = 0; x < image.width; ++x) {
      const Color& color = image.at(x, y);
      row[x] = 0xFF000000U | (std::uint32_t(color.red) << 16) | (std::uint32_t(color.green) << 8) |
               color.blue;
    }
  }
  cairo_surface_mark_dirty(surface);
}

Image copyFrom(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  Image image(cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface), {});
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int y = 0; y < image.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(data + std::ptrdiff_t(y) * stride);
    for (int x = 0; x < image.width; ++x) {
      image.at(x, y) = {static_cast<std::uint8_t>(row[x] >> 16),
                        static_cast<std::uint8_t>(row[x] >> 8), static_cast<std::uint8_t>(row[x])};
    }
  }
  return image;
}

cairo_status_t appendBytes(void* target, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(target)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

double widthOf(cairo_t* context, const std::string& text) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

void write(cairo_t* context, std::string text, double x, double y, double size, const Color& color,
           bool bold, double max_width) {
  cairo_select_font_face(context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, size);
  cairo_set_source_rgb(context, color.red / 255.0, color.green / 255.0, color.blue / 255.0);
  if (widthOf(context, text) > max_width) {
    while (!text.empty() && widthOf(context, text + "…") > max_width) {
      do text.pop_back();  // Whole UTF-8 sequences only.
      while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80);
      if (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0xC0)
        text.pop_back();
    }
    text += "…";
  }
  cairo_move_to(context, x, y);
  cairo_show_text(context, text.c_str());
}

void frame(cairo_t* context, int x, int y, const Image& image) {
  cairo_set_source_rgb(context, 0.85, 0.45, 0.1);
  cairo_set_line_width(context, 3);
  cairo_rectangle(context, x + 1.5, y + 1.5, image.width - 3, image.height - 3);
  cairo_stroke(context);
}

void trace(cairo_t* context, const Shape& shape) {
  cairo_new_path(context);
  for (const Outline& outline : shape.outlines) {
    cairo_new_sub_path(context);
    for (const auto& [x, y] : outline) {
      if (!std::isfinite(x) || !std::isfinite(y)) break;
      cairo_line_to(context, x, y);
    }
    if (shape.closed) cairo_close_path(context);
  }
}

void setColor(cairo_t* context, const Color& color, double opacity) {
  cairo_set_source_rgba(context, color.red / 255.0, color.green / 255.0, color.blue / 255.0,
                        opacity);
}

void draw(cairo_t* context, const Shape& shape) {
  trace(context, shape);
  if (shape.style.fill) {
    setColor(context, *shape.style.fill, shape.style.opacity);
    cairo_fill_preserve(context);
  }
  if (shape.style.stroke) {
    setColor(context, *shape.style.stroke, shape.style.opacity);
    cairo_set_line_width(context, shape.style.stroke_width);
    cairo_stroke(context);
  }
}

}  // namespace

Result<Image> drawShapes(const std::vector<Shape>& shapes, int width, int height,
                         const std::vector<Words>& words) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (const auto status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS) {
    return cairoError(status);
  }
  const Drawing context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(context.get(), CAIRO_LINE_CAP_ROUND);
  for (const Shape& shape : shapes) draw(context.get(), shape);
  for (const Words& w : words) {
    write(context.get(), w.text, w.x, w.y, w.size, w.color, w.bold, w.max_width);
  }
  return copyFrom(surface.get());
}

Result<std::string> encodePng(const Image& image) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  if (const auto status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS) {
    return cairoError(status);
  }
  copyTo(surface.get(), image, 0, 0);
  std::string bytes;
  const auto status = cairo_surface_write_to_png_stream(surface.get(), appendBytes, &bytes);
  if (status != CAIRO_STATUS_SUCCESS) return cairoError(status);
  return bytes;
}

Result<Image> composeSheet(const std::string& heading, const std::vector<SheetCell>& cells,
                           int columns) {
  if (cells.empty() || columns < 1) {
    return Status(Reason::kInvalidOption, "a sheet needs at least one picture and one column");
  }
  columns = std::min<int>(columns, static_cast<int>(cells.size()));
  int cell_width = 0, cell_height = 0;
  for (const SheetCell& cell : cells) {
    cell_width = std::max(cell_width, cell.image.width);
    cell_height = std::max(cell_height, cell.image.height);
  }
  const int rows = (static_cast<int>(cells.size()) + columns - 1) / columns;
  const int width = kSheetMargin + columns * (cell_width + kSheetMargin);
  const int height = kSheetHeading + rows * (cell_height + kSheetWords) + kSheetMargin;
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  if (const auto status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS) {
    return cairoError(status);
  }
  const Drawing context(cairo_create(surface.get()));
  cairo_set_source_rgb(context.get(), 1, 1, 1);
  cairo_paint(context.get());
  write(context.get(), heading, kSheetMargin, 29, 18, kDark, true, width - 2 * kSheetMargin);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int x = kSheetMargin + static_cast<int>(i) % columns * (cell_width + kSheetMargin);
    const int y = kSheetHeading + static_cast<int>(i) / columns * (cell_height + kSheetWords);
    copyTo(surface.get(), cells[i].image, x, y);
    if (cells[i].highlighted) frame(context.get(), x, y, cells[i].image);
    write(context.get(), cells[i].title, x, y + cell_height + 17, 13, kDark, true, cell_width);
    write(context.get(), cells[i].subtitle, x, y + cell_height + 34, 12, kGrey, false, cell_width);
  }
  return copyFrom(surface.get());
}

}  // namespace moduli
