#include "engine/io/json_members.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <utility>

namespace bris {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
bool is_bare(char c) { // of numbers, true, false, null, and what others write, as NaN
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '+' || c == '.' || c == '_';
}

} // namespace

JsonMembers::JsonMembers(std::string_view text) : text_(text) {}

void JsonMembers::refuse(const char* why) const {
    throw InputError(fmt::format("expected an object of JSON, found \"{}\" ({} at character {})",
                                 beginning_of(text_), why, at_ + 1));
}

/// The next character that is no blank; 0: there is none.
char JsonMembers::look() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
}

void JsonMembers::expect(char c, const char* why) {
    if (look() != c) refuse(at_ < text_.size() ? why : "unexpected end");
    ++at_;
}

std::optional<JsonMembers::Member> JsonMembers::next() {
    if (!begun_) expect('{', "expected '{'");
    const bool is_first = !std::exchange(begun_, true);
    if (look() == '}') {
        ++at_;
        if (look(); at_ < text_.size()) refuse("expected the end");
        return {};
    }
    if (!is_first) expect(',', "expected ',' or '}'");
    if (look() != '"') refuse(at_ < text_.size() ? "expected a name" : "unexpected end");
    const std::string_view quoted = string();
    std::string_view name = quoted.substr(1, quoted.size() - 2);
    if (name.find('\\') != std::string_view::npos) {
        name_ = json_text(quoted).value_or(std::string(name));
        name = name_;
    }
    expect(':', "expected ':'");
    return Member{name, value()};
}

/// A string with its quotes.
std::string_view JsonMembers::string() {
    const std::size_t begin = at_++;
    while (at_ < text_.size() && text_[at_] != '"') at_ += text_[at_] == '\\' ? 2u : 1u;
    if (at_ >= text_.size()) {
        at_ = text_.size();
        refuse("unexpected end");
    }
    return text_.substr(begin, ++at_ - begin);
}

std::string_view JsonMembers::value() {
    const char first = look();
    const std::size_t begin = at_;
    if (first == '"') return string();
    if (first == '{' || first == '[')
        skip_nested();
    else
        while (at_ < text_.size() && is_bare(text_[at_])) ++at_;
    if (at_ == begin) refuse(at_ < text_.size() ? "expected a value" : "unexpected end");
    return text_.substr(begin, at_ - begin);
}

/// Goes behind an object or array. Only brackets and strings are looked at.
void JsonMembers::skip_nested() {
    std::string open; // the brackets that are to come
    do {
        const char c = look();
        if (at_ >= text_.size()) refuse("unexpected end");
        if (c == '"') {
            (void)string();
            continue;
        }
        if (c == '{' || c == '[') open += c == '{' ? '}' : ']';
        if (c == '}' || c == ']') {
            if (open.back() != c) refuse("unexpected bracket");
            open.pop_back();
        }
        ++at_;
    } while (!open.empty());
}

std::optional<double> json_number(std::string_view value) {
    if (value.starts_with('"')) {
        const auto text = value.substr(1, value.size() - 2);
        return text.empty() ? std::nullopt : number_of(text);
    }
    // from_chars alone takes "nan" and "inf", too
    const std::size_t digits = value.starts_with('-') ? 1 : 0;
    const char first = digits < value.size() ? value[digits] : '\0';
    double number = 0;
    const char* const end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, number);
    if (!(first == '.' || (first >= '0' && first <= '9')) || error != std::errc{} || stop != end)
        return {};
    return number;
}

std::optional<std::string> json_text(std::string_view value) {
    if (value.size() < 2 || !value.starts_with('"')) return {};
    auto parsed = nlohmann::json::parse(value, nullptr, false);
    if (!parsed.is_string()) return {};
    return std::move(parsed.get_ref<std::string&>());
}

std::optional<std::string> json_string(std::string_view text) {
    // most texts, such as records, are as they are
    const auto is_plain = [](char c) { return c >= ' ' && c < 127 && c != '"' && c != '\\'; };
    if (std::ranges::all_of(text, is_plain)) return '"' + std::string(text) + '"';
    try {
        return nlohmann::json(text).dump();
    } catch (const nlohmann::json::type_error&) {
        return {};
    }
}

} // namespace bris
