#include "interchange/usd/usd_text.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::interchange {

namespace {

constexpr uint64_t kMaxUsdBytes = uint64_t{1} << 30;
constexpr int kMaxUsdNesting = 100;  // of prims, and of brackets in a value

enum class UsdTokenKind { kEnd, kWord, kNumber, kText, kSign };

struct UsdToken {
    UsdTokenKind kind = UsdTokenKind::kEnd;
    std::string text;  // of a sign its one character
    double number = 0;
    size_t line = 1;

    bool is(const char* sign) const { return kind == UsdTokenKind::kSign && text == sign; }
};

bool begins_word(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}
bool is_of_word(char c) {
    return begins_word(c) || std::isdigit(static_cast<unsigned char>(c)) || c == ':' || c == '.';
}

class UsdLexer {
  public:
    UsdLexer(std::string text, std::string file) : text_(std::move(text)), file_(std::move(file)) { next(); }

    const UsdToken& token() const { return token_; }
    void next();
    [[noreturn]] void fail(const std::string& problem) const {
        throw InputError(file_, fmt::format("line {}", token_.line), problem, "write the .usda again");
    }
    void take(const char* sign) {
        if (!token_.is(sign)) fail(fmt::format("has no {} where one belongs", sign));
        next();
    }
    // Whether the token is a sign; if so, it is taken.
    bool took(const char* sign) {
        if (!token_.is(sign)) return false;
        next();
        return true;
    }

  private:
    void skip_space();
    void take_quoted(std::string_view quote);
    void take_number();

    std::string text_, file_;
    size_t at_ = 0, line_ = 1;
    UsdToken token_;
};

void UsdLexer::skip_space() {
    for (; at_ < text_.size(); ++at_) {
        if (text_[at_] == '#')
            while (at_ < text_.size() && text_[at_] != '\n') ++at_;
        if (at_ == text_.size()) return;
        if (text_[at_] == '\n')
            ++line_;
        else if (text_[at_] != ' ' && text_[at_] != '\t' && text_[at_] != '\r' && text_[at_] != ';')
            return;
    }
}

// Text between two quotes; inside of "…" and '…', a backslash keeps the next character.
void UsdLexer::take_quoted(std::string_view quote) {
    at_ += quote.size();
    token_.kind = UsdTokenKind::kText;
    while (std::string_view(text_).substr(at_, quote.size()) != quote) {
        if (at_ < text_.size() && text_[at_] == '\\' && quote[0] != '@') ++at_;
        if (at_ >= text_.size()) fail("begins a text that does not end");
        if (text_[at_] == '\n') ++line_;
        token_.text += text_[at_++];
    }
    at_ += quote.size();
}

void UsdLexer::take_number() {
    const char* begin = text_.data() + at_ + (text_[at_] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), token_.number);
    if (error != std::errc()) fail("has a number that is none");
    token_.kind = UsdTokenKind::kNumber;
    at_ = static_cast<size_t>(end - text_.data());
}

void UsdLexer::next() {
    skip_space();
    token_ = {UsdTokenKind::kEnd, "", 0, line_};
    if (at_ >= text_.size()) return;
    const char c = text_[at_];
    for (const std::string_view quote : {"\"\"\"", "'''", "\"", "'", "@@@", "@"})
        if (std::string_view(text_).substr(at_, quote.size()) == quote) return take_quoted(quote);
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '-' || c == '+' ||
        (c == '.' && at_ + 1 < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_ + 1]))))
        return take_number();
    if (c == '<') {
        const size_t end = text_.find('>', at_);
        if (end == std::string::npos) fail("begins a path that does not end");
        token_.kind = UsdTokenKind::kText;
        token_.text = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        return;
    }
    token_.kind = begins_word(c) ? UsdTokenKind::kWord : UsdTokenKind::kSign;
    do {
        token_.text += text_[at_++];
    } while (token_.kind == UsdTokenKind::kWord && at_ < text_.size() && is_of_word(text_[at_]));
    if (token_.kind == UsdTokenKind::kWord && (token_.text == "inf" || token_.text == "nan")) {
        token_.kind = UsdTokenKind::kNumber;
        token_.number = token_.text == "inf" ? INFINITY : NAN;
    }
}

class UsdParser {
  public:
    UsdParser(std::string text, const std::string& file) : lexer_(std::move(text), file) {}
    UsdLayer layer();

  private:
    void skip_dictionary(int depth);
    void add_value(UsdValue& value, int depth);
    std::map<std::string, UsdValue> metadata();
    void add_samples(UsdAttribute& attribute);
    void add_property(UsdPrim& prim);
    UsdPrim prim(int depth);
    bool is_specifier() const {
        const UsdToken& token = lexer_.token();
        return token.kind == UsdTokenKind::kWord &&
               (token.text == "def" || token.text == "over" || token.text == "class");
    }
    std::string take_text(UsdTokenKind kind, const char* what) {
        if (lexer_.token().kind != kind) lexer_.fail(fmt::format("has no {} where one belongs", what));
        std::string text = lexer_.token().text;
        lexer_.next();
        return text;
    }

    UsdLexer lexer_;
};

void UsdParser::skip_dictionary(int depth) {
    if (depth > kMaxUsdNesting) lexer_.fail("nests too deep");
    lexer_.take("{");
    while (!lexer_.token().is("}")) {
        if (lexer_.token().kind == UsdTokenKind::kEnd) lexer_.fail("ends inside of braces");
        if (lexer_.token().is("{"))
            skip_dictionary(depth + 1);
        else
            lexer_.next();
    }
    lexer_.next();
}

void UsdParser::add_value(UsdValue& value, int depth) {
    if (depth > kMaxUsdNesting) lexer_.fail("nests too deep");
    const UsdToken& token = lexer_.token();
    if (token.is("{")) return skip_dictionary(depth);
    if (token.kind == UsdTokenKind::kNumber) {
        value.numbers.push_back(token.number);
        return lexer_.next();
    }
    if (token.kind == UsdTokenKind::kText || token.kind == UsdTokenKind::kWord) {
        if (token.text != "None") value.texts.push_back(token.text);
        return lexer_.next();
    }
    const bool list = token.is("[");
    lexer_.take(list ? "[" : "(");
    const char* end = list ? "]" : ")";
    while (!lexer_.took(end)) {
        if (lexer_.token().kind == UsdTokenKind::kEnd) lexer_.fail("ends inside of a value");
        add_value(value, depth + 1);
        lexer_.took(",");
        lexer_.took("=");  // of a reference's "(offset = 2)"
    }
}

// Between parentheses: names with values, and texts of documentation.
std::map<std::string, UsdValue> UsdParser::metadata() {
    std::map<std::string, UsdValue> found;
    if (!lexer_.took("(")) return found;
    while (!lexer_.took(")")) {
        if (lexer_.token().kind == UsdTokenKind::kText) {
            lexer_.next();
            continue;
        }
        std::string name = take_text(UsdTokenKind::kWord, "name");
        // "prepend references": the second word is the name.
        while (lexer_.token().kind == UsdTokenKind::kWord) name = take_text(UsdTokenKind::kWord, "name");
        lexer_.take("=");
        UsdValue value;
        add_value(value, 0);
        // A reference has the path of a prim, and perhaps an offset in time, behind the file.
        while (lexer_.token().kind == UsdTokenKind::kText || lexer_.token().is("(")) add_value(value, 0);
        found[name] = std::move(value);
    }
    return found;
}

void UsdParser::add_samples(UsdAttribute& attribute) {
    lexer_.take("{");
    while (!lexer_.took("}")) {
        if (lexer_.token().kind != UsdTokenKind::kNumber || !std::isfinite(lexer_.token().number))
            lexer_.fail("has no time code where one belongs");
        const double time = lexer_.token().number;
        if (!attribute.samples.empty() && !(time > attribute.samples.back().first))
            lexer_.fail(fmt::format("has the time code {}, which does not ascend", time));
        lexer_.next();
        lexer_.take(":");
        UsdValue value;
        add_value(value, 0);
        attribute.samples.emplace_back(time, std::move(value));
        lexer_.took(",");
    }
}

// "uniform token[] xformOpOrder = […] ( … )": the last word of the line is the name, the one before it the type.
void UsdParser::add_property(UsdPrim& prim) {
    const size_t line = lexer_.token().line;
    std::string name, type;
    while (lexer_.token().kind == UsdTokenKind::kWord && lexer_.token().line == line) {
        type = name;
        name = take_text(UsdTokenKind::kWord, "name");
        if (lexer_.took("[")) {
            lexer_.take("]");
            name += "[]";
        }
    }
    if (name.empty()) lexer_.fail("has no attribute where one belongs");
    if (name == "variantSet") {
        take_text(UsdTokenKind::kText, "variant set's name");
        lexer_.take("=");
        return skip_dictionary(0);
    }
    const std::string suffix = ".timeSamples";
    const bool sampled = name.ends_with(suffix);
    if (sampled) name.resize(name.size() - suffix.size());
    UsdAttribute& attribute = prim.attributes[name];
    attribute.type = type;
    if (lexer_.took("=")) {
        if (sampled) {
            attribute.samples.clear();
            add_samples(attribute);
        } else {
            attribute.value = {};
            add_value(attribute.value, 0);
        }
    }
    metadata();
}

UsdPrim UsdParser::prim(int depth) {
    if (depth > kMaxUsdNesting) lexer_.fail("nests too deep");
    UsdPrim prim;
    prim.specifier = take_text(UsdTokenKind::kWord, "specifier");
    if (lexer_.token().kind == UsdTokenKind::kWord) prim.type = take_text(UsdTokenKind::kWord, "type");
    prim.name = take_text(UsdTokenKind::kText, "prim's name");
    prim.metadata = metadata();
    lexer_.take("{");
    while (!lexer_.took("}")) {
        if (is_specifier())
            prim.children.push_back(this->prim(depth + 1));
        else
            add_property(prim);
    }
    return prim;
}

UsdLayer UsdParser::layer() {
    UsdLayer layer;
    layer.metadata = metadata();
    while (lexer_.token().kind != UsdTokenKind::kEnd) {
        if (!is_specifier()) lexer_.fail("has no prim where one belongs");
        layer.prims.push_back(prim(0));
    }
    return layer;
}

}  // namespace

double UsdLayer::number(const std::string& name, double fallback) const {
    const auto found = metadata.find(name);
    return found == metadata.end() || found->second.numbers.empty() ? fallback : found->second.numbers[0];
}

std::string UsdLayer::text(const std::string& name, const std::string& fallback) const {
    const auto found = metadata.find(name);
    return found == metadata.end() || found->second.texts.empty() ? fallback : found->second.texts[0];
}

UsdLayer read_usda(const std::filesystem::path& file) {
    const std::vector<uint8_t> bytes = read_file(file, kMaxUsdBytes);
    std::string text(bytes.begin(), bytes.end());
    if (text.starts_with("PXR-USDC"))
        throw InputError(file.string(), "", "is a binary file of USD", "convert it: usdcat FILE -o FILE.usda");
    if (!text.starts_with("#usda "))
        throw InputError(file.string(), "", "does not begin with #usda", "give a .usda of OpenUSD");
    return UsdParser(std::move(text), file.string()).layer();
}

}  // namespace neuvv::interchange
