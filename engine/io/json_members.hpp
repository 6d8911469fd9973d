#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bris {

/// The members of an object of JSON, one after the other, with their values as they are written:
/// who does not use a member does not parse its value either, whatever it holds (numbers that JSON
/// does not have, such as NaN, texts that are not UTF-8, any depth). Nothing is copied.
class JsonMembers {
public:
    struct Member {
        std::string_view name;  ///< valid until the next call
        std::string_view value; ///< part of the text
    };
    /// The text has to live longer.
    explicit JsonMembers(std::string_view text);
    /// The next member; nothing: the object has ended, and so has the text. Throws InputError,
    /// without a place: what was expected and what was found.
    std::optional<Member> next();

private:
    [[noreturn]] void refuse(const char* why) const;
    char look();
    void expect(char c, const char* why);
    std::string_view string();
    std::string_view value();
    void skip_nested();

    std::string_view text_;
    std::size_t at_ = 0;
    bool begun_ = false;
    std::string name_; // of a member whose name has escapes
};

/// A value of JSON as a number: a number, also in quotes, where it may be "nan". Nothing: it is
/// something else.
std::optional<double> json_number(std::string_view value);
/// A value of JSON as a text. Nothing: it is no string, or not valid.
std::optional<std::string> json_text(std::string_view value);
/// A text as a string of JSON, with its quotes. Nothing: it is not UTF-8.
std::optional<std::string> json_string(std::string_view text);

} // namespace bris
