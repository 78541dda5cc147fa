#include "core/picture/svg.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/base/text.h"

namespace moduli {
namespace {

// The shortest decimal of a number rounded to hundredths.
std::string decimal(double value) {
  if (!std::isfinite(value)) return "0";
  std::array<char, 400> buffer;  // The largest double has 309 digits before the point.
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                          std::chars_format::fixed, 2);
  std::string text(buffer.data(), end);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string attribute(std::string_view name, double value) {
  return ' ' + std::string(name) + "=\"" + decimal(value) + '"';
}

std::string hex(const Color& color) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text = "#";
  for (const std::uint8_t channel : {color.red, color.green, color.blue}) {
    text += kDigits[channel >> 4];
    text += kDigits[channel & 15];
  }
  return text;
}

std::string attributes(const SvgStyle& style) {
  std::string text = " fill=\"" + (style.fill ? hex(*style.fill) : "none") + '"';
  if (style.stroke) {
    text += " stroke=\"" + hex(*style.stroke) + "\" stroke-linejoin=\"round\"" +
            attribute("stroke-width", style.stroke_width);
  }
  if (style.opacity < 1) text += attribute("opacity", style.opacity);
  return text;
}

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

// The first characters that fit, with an ellipsis where some do not. Letters are taken to be 0.58
// sizes wide, some more than the mean of common sans-serif faces.
std::string cutOff(std::string_view text, double size, double max_width) {
  const auto limit = static_cast<std::size_t>(std::max(0.0, max_width / (0.58 * size)));
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (continues(text[i])) continue;
    if (++letters > limit) return std::string(text.substr(0, i)) + "…";
  }
  return std::string(text);
}

}  // namespace

SvgPath& SvgPath::point(char command, double x, double y) {
  data_ += command;
  data_ += decimal(x);
  data_ += ' ';
  data_ += decimal(y);
  return *this;
}

SvgPath& SvgPath::close() {
  data_ += 'Z';
  return *this;
}

Svg::Svg(int width, int height) {
  const std::string w = std::to_string(width), h = std::to_string(height);
  text_ =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "width=\"" +
      w + "\" height=\"" + h + "\" viewBox=\"0 0 " + w + ' ' + h +
      "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

void Svg::path(const SvgPath& path, const SvgStyle& style) {
  if (path.empty()) return;
  text_ += "<path" + attributes(style) + " d=\"" + path.data() + "\"/>\n";
}

void Svg::circle(double x, double y, double radius, const SvgStyle& style) {
  text_ += "<circle" + attribute("cx", x) + attribute("cy", y) + attribute("r", radius) +
           attributes(style) + "/>\n";
}

void Svg::shadeBall(double x, double y, double radius) {
  const std::string name = "ball" + std::to_string(names_++);
  text_ += "<radialGradient id=\"" + name +
           "\" cx=\"0.38\" cy=\"0.32\" r=\"0.72\"><stop offset=\"0\" stop-color=\"#ffffff\" "
           "stop-opacity=\"0.18\"/><stop offset=\"0.45\" stop-color=\"#202838\" "
           "stop-opacity=\"0\"/><stop offset=\"1\" stop-color=\"#202838\" "
           "stop-opacity=\"0.42\"/></radialGradient>\n<circle fill=\"url(#" +
           name + ")\"" + attribute("cx", x) + attribute("cy", y) + attribute("r", radius) + "/>\n";
}

void Svg::image(std::string_view png, double x, double y, double width, double height) {
  text_ += "<image" + attribute("x", x) + attribute("y", y) + attribute("width", width) +
           attribute("height", height) + " href=\"data:image/png;base64," + base64(png) + "\"/>\n";
}

void Svg::text(std::string_view text, double x, double y, double size, const Color& color,
               bool bold, double max_width) {
  text_ += "<text" + attribute("x", x) + attribute("y", y) + attribute("font-size", size) +
           " font-family=\"DejaVu Sans, Verdana, sans-serif\"" +
           (bold ? " font-weight=\"bold\"" : "") + " fill=\"" + hex(color) + "\">" +
           xmlText(cutOff(text, size, max_width)) + "</text>\n";
}

void Svg::beginClip(const SvgPath& path) {
  const std::string name = "clip" + std::to_string(names_++);
  text_ += "<clipPath id=\"" + name + "\"><path d=\"" + path.data() +
           "\"/></clipPath>\n<g clip-path=\"url(#" + name + ")\">\n";
}

void Svg::endClip() {
  text_ += "</g>\n";
}

std::string Svg::finish() && {
  return std::move(text_) + "</svg>\n";
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
      group = (group << 8) | byte;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[(group >> (18 - 6 * k)) & 63] : '=';
    }
  }
  return text;
}

}  // namespace moduli
