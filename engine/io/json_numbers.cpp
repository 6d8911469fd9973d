#include "engine/io/json_numbers.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace bris {

namespace {

using nlohmann::json;

/// "[json.exception.parse_error.101] parse error at line 1, column 9: syntax error while parsing
/// value - unexpected end of input; expected ..." -> "unexpected end of input".
std::string reason_of(const std::string& message) {
    const auto dash = message.find(" - "), bracket = message.find("] ");
    std::size_t start = 0;
    if (bracket != std::string::npos) start = bracket + 2;
    if (dash != std::string::npos) start = dash + 3;
    const std::size_t end = std::min(message.find(';', start), start + 100); // not a long number
    return message.substr(start, end - start);
}

/// Takes the numbers as they are read; nothing is nested, so nothing is kept.
class FlatObject : public nlohmann::json_sax<json> {
public:
    explicit FlatObject(const std::string& text) : text_(text) {}
    std::map<std::string, double> numbers;

    bool null() override {
        check_inside();
        return true;
    }
    bool boolean(bool value) override {
        check_inside();
        refuse(value ? "true" : "false");
    }
    bool number_integer(number_integer_t value) override { return add(static_cast<double>(value)); }
    bool number_unsigned(number_unsigned_t value) override {
        return add(static_cast<double>(value));
    }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override {
        check_inside();
        const auto number = value.empty() ? std::nullopt : number_of(value);
        if (!number) refuse(value);
        return add(*number);
    }
    bool binary(binary_t&) override { refuse("bytes"); }
    bool start_object(std::size_t) override {
        if (inside_) reject_nested();
        inside_ = true;
        return true;
    }
    bool key(string_t& name) override {
        name_ = name;
        return true;
    }
    bool end_object() override { return true; }
    bool start_array(std::size_t) override { reject_nested(); }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string&,
                     const nlohmann::detail::exception& error) override {
        throw InputError(
            fmt::format("expected an object of JSON, found \"{}\" ({} at character {})",
                        beginning_of(text_), reason_of(error.what()), position));
    }

private:
    bool add(double number) {
        check_inside();
        require(numbers.emplace(name_, number).second,
                fmt::format("{}: expected once, found twice", name_));
        return true;
    }
    void check_inside() const {
        require(inside_,
                fmt::format("expected an object of JSON, found \"{}\"", beginning_of(text_)));
    }
    [[noreturn]] void refuse(const std::string& found) const {
        throw InputError(
            fmt::format("{}: expected a number, found \"{}\"", name_, beginning_of(found)));
    }
    [[noreturn]] void reject_nested() const {
        throw InputError(
            fmt::format("expected a flat object of JSON, found \"{}\"", beginning_of(text_)));
    }

    const std::string& text_;
    std::string name_; // read last
    bool inside_ = false;
};

} // namespace

std::string beginning_of(const std::string& text) {
    return text.size() > 40 ? text.substr(0, 40) + "..." : text;
}

std::map<std::string, double> json_numbers(const std::string& text) {
    FlatObject object(text);
    (void)json::sax_parse(text, &object);
    return std::move(object.numbers);
}

} // namespace bris
