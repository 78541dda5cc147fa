// The one place that knows expat.
#include "core/mesh/xml_reader.h"

#include <expat.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

namespace moduli {
namespace {

struct FreeParser {
  void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};
using ParserPointer = std::unique_ptr<std::remove_pointer_t<XML_Parser>, FreeParser>;

class XmlReading {
 public:
  XmlReading(const Scanner& document, XmlHandler& handler)
      : document_(document), handler_(handler), parser_(XML_ParserCreate(nullptr)) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), onOpen, onClose);
    XML_SetCharacterDataHandler(parser_.get(), onText);
    XML_SetEntityDeclHandler(parser_.get(), onEntityDeclaration);
    XML_SetSkippedEntityHandler(parser_.get(), onSkippedEntity);
  }

  Status read(Context& context);

 private:
  Status parserFailure() const;
  Status placed(const Status& status) const;

  const char* place() const {
    const XML_Index index = XML_GetCurrentByteIndex(parser_.get());
    const auto offset = index < 0 ? std::size_t{0} : static_cast<std::size_t>(index);
    return document_.at() + std::min(offset, document_.left());
  }

  // Does the work of one event unless an earlier one has failed.
  template <typename Work>
  static void event(void* user, const Work& work) {
    auto& self = *static_cast<XmlReading*>(user);
    if (!self.status_.ok()) return;
    self.status_ = work(self);
    if (self.status_.ok()) return;
    self.status_ = self.placed(self.status_);
    XML_StopParser(self.parser_.get(), XML_FALSE);
  }

  static void onOpen(void* user, const XML_Char* name, const XML_Char** attributes) {
    event(user, [&](XmlReading& self) {
      self.attributes_.clear();
      for (; *attributes != nullptr; attributes += 2) {
        self.attributes_.push_back({attributes[0], attributes[1]});
      }
      const auto offset = static_cast<std::size_t>(self.place() - self.document_.at());
      return self.handler_.open(name, self.attributes_, offset);
    });
  }
  static void onClose(void* user, const XML_Char* name) {
    event(user, [&](XmlReading& self) { return self.handler_.close(name); });
  }
  static void onText(void* user, const XML_Char* text, int length) {
    event(user, [&](XmlReading& self) {
      return self.handler_.text({text, static_cast<std::size_t>(length)});
    });
  }
  static void onEntityDeclaration(void* user, const XML_Char* name, int /*is_parameter*/,
                                  const XML_Char* /*value*/, int /*length*/,
                                  const XML_Char* /*base*/, const XML_Char* /*system*/,
                                  const XML_Char* /*public*/, const XML_Char* /*notation*/) {
    event(user, [&](XmlReading&) { return refuseEntity(name); });
  }
  static void onSkippedEntity(void* user, const XML_Char* name, int /*is_parameter*/) {
    event(user, [&](XmlReading&) { return refuseEntity(name); });
  }
  static Status refuseEntity(std::string_view name) {
    return {Reason::kUnsupportedContent, "uses an entity of its own, " + quoted(name),
            "write the text itself in place of the entity"};
  }

  const Scanner& document_;
  XmlHandler& handler_;
  ParserPointer parser_;
  std::vector<XmlAttribute> attributes_;
  Status status_;
};

Status XmlReading::placed(const Status& status) const {
  if (status.reason() == Reason::kCancelled || status.reason() == Reason::kDeadlineExceeded) {
    return status;
  }
  return document_.textError(status.reason(), place(), status.message(), status.hint());
}

Status XmlReading::parserFailure() const {
  const XML_Error error = XML_GetErrorCode(parser_.get());
  if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
  const bool cut = error == XML_ERROR_NO_ELEMENTS || error == XML_ERROR_UNCLOSED_TOKEN ||
                   error == XML_ERROR_UNCLOSED_CDATA_SECTION || error == XML_ERROR_PARTIAL_CHAR;
  const XML_LChar* words = XML_ErrorString(error);
  return placed({cut ? Reason::kTruncatedFile : Reason::kSyntaxError,
                 "is no well-formed XML: " + std::string(words != nullptr ? words : "damaged"),
                 cut ? "the file was cut off; copy or export it again"
                     : "correct the line, or export the file again"});
}

Status XmlReading::read(Context& context) {
  // A token longer than a piece is looked at again with every piece: sixteen pieces bound that.
  constexpr std::size_t kLeast = std::size_t{1} << 20;
  constexpr std::size_t kMost = std::size_t{1} << 30;
  const std::size_t size = document_.left();
  const std::size_t piece = std::clamp(size / 16, kLeast, kMost);
  for (std::size_t fed = 0; fed < size || fed == 0; fed += piece) {
    RETURN_IF_ERROR(context.check());
    const std::size_t length = std::min(piece, size - fed);
    const bool last = fed + length == size;
    const XML_Status answer =
        XML_Parse(parser_.get(), document_.at() + fed, static_cast<int>(length), last ? 1 : 0);
    RETURN_IF_ERROR(status_);
    if (answer != XML_STATUS_OK) return parserFailure();
  }
  return {};
}

}  // namespace

Status readXml(Context& context, const Scanner& document, XmlHandler& handler) {
  return XmlReading(document, handler).read(context);
}

}  // namespace moduli
