#include "engine/options.hpp"

#include "engine/errors.hpp"
#include "engine/exit_codes.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <stdexcept>

namespace bris {

namespace {

template <class... Fs>
struct Overloaded : Fs... {
    using Fs::operator()...;
};
template <class... Fs>
Overloaded(Fs...) -> Overloaded<Fs...>; // clang before 17 does not deduce it

std::string flag(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return "--" + name;
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Reads the whole text as a number; false if it is none.
template <class T>
bool read_number(std::string_view text, T& value) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc{} && stop == end && !text.empty();
}

/// Joins words with a separator; empty words are left out.
std::string joined(const std::vector<std::string>& words, const char* separator) {
    std::string text;
    for (const std::string& word : words)
        if (!word.empty()) text += (text.empty() ? "" : separator) + word;
    return text;
}

std::vector<std::string> split_list(std::string text) {
    text = trimmed(text);
    if (text.size() > 1 && text.front() == '[' && text.back() == ']')
        text = trimmed(text.substr(1, text.size() - 2));
    std::vector<std::string> parts;
    for (std::size_t start = 0; !text.empty() && start <= text.size();) {
        const std::size_t comma = std::min(text.find(',', start), text.size());
        parts.push_back(trimmed(text.substr(start, comma - start)));
        start = comma + 1;
    }
    return parts;
}

bool contains(const Range& range, double x) {
    return std::isfinite(x) && (range.low_accepted ? x >= range.low : x > range.low) &&
           (range.high_accepted ? x <= range.high : x < range.high);
}

/// " above 0", " from 0 to 1", " of at least 0 and below 90", or nothing.
std::string words(const Range& range) {
    const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
    if (low && high && range.low_accepted && range.high_accepted)
        return fmt::format(" from {} to {}", range.low, range.high);
    std::string text;
    if (low) text = fmt::format(" {} {}", range.low_accepted ? "of at least" : "above", range.low);
    if (low && high) text += " and";
    if (high)
        text += fmt::format(" {} {}",
                            !range.high_accepted ? "below"
                            : low                ? "at most"
                                                 : "of at most",
                            range.high);
    return text;
}

bool has_usual(const Range& range) { return std::isfinite(range.usual_low); }

bool is_usual(const Range& range, double x) {
    return !has_usual(range) || (x >= range.usual_low && x <= range.usual_high);
}

/// The question whether a number was typed in a multiple of the unit (kPa, mm, g/cm3 ...); "".
std::string hint_at_unit(const Range& range, double x) {
    for (const auto& [factor, power] :
         {std::pair{1e3, "e3"}, {1e-3, "e-3"}, {1e6, "e6"}, {1e-6, "e-6"}})
        if (x > 0 && is_usual(range, factor * x)) return fmt::format(": {:.15g}{}?", x, power);
    return "";
}

std::string in_unit(const std::string& unit) {
    return unit.empty() || unit == "-" ? "" : fmt::format(" ({})", unit);
}

[[noreturn]] void reject(const std::string& where, const std::string& expected,
                         const std::string& found) {
    constexpr std::size_t most = 200; // letters that a message cites
    throw InputError(fmt::format("{}: expected {}, found \"{}\"{}", where, expected,
                                 found.substr(0, most), found.size() > most ? " ..." : ""));
}

/// Sets one member from its text. Throws InputError with a message that begins with `where`.
struct Assign {
    const std::string& where;
    const std::string& text;
    const std::string& unit;
    const Range& range;
    const std::vector<std::string>& choices;

    void operator()(double* value) const {
        double x = 0;
        if (!read_number(text, x) || !contains(range, x))
            reject(where, "a number" + words(range) + in_unit(unit), text);
        *value = x;
    }
    void operator()(unsigned* value) const { whole(value); }
    void operator()(std::uint64_t* value) const { whole(value); }
    void operator()(std::vector<double>* value) const {
        std::vector<double> list;
        for (const std::string& part : split_list(text)) {
            double x = 0;
            if (!read_number(part, x) || !contains(range, x))
                reject(where, "numbers" + words(range) + in_unit(unit) + " separated by commas",
                       text);
            list.push_back(x);
        }
        *value = list;
    }
    void operator()(bool* value) const {
        if (text != "true" && text != "false") reject(where, "true or false", text);
        *value = text == "true";
    }
    void operator()(std::string* value) const {
        if (!choices.empty() && std::find(choices.begin(), choices.end(), text) == choices.end())
            reject(where, "one of " + joined(choices, ", "), text);
        *value = text;
    }
    void operator()(std::filesystem::path* value) const { *value = text; }
    void operator()(const auto& choice) const {
        const auto found = std::ranges::find(choices, text);
        if (found == choices.end()) reject(where, "one of " + joined(choices, ", "), text);
        choice.set(choice.value, static_cast<std::size_t>(found - choices.begin()));
    }

private:
    /// The range, or else that of the type.
    template <class T>
    std::string limits() const {
        const std::string given = words(range);
        return given.empty() ? fmt::format(" from 0 to {}", std::numeric_limits<T>::max()) : given;
    }
    template <class T>
    void whole(T* value) const {
        T x = 0;
        if (!read_number(text, x) || !contains(range, static_cast<double>(x)))
            reject(where, "a whole number" + limits<T>() + in_unit(unit), text);
        *value = x;
    }
};

/// Number of letters to insert, delete or replace to turn one word into the other.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, replaced});
        }
    }
    return row.back();
}

/// Whether a word is a flag rather than the value of the flag before it. A negative number, a name
/// that begins with one dash, and a single dash are values.
bool is_flag(const std::string& word) { return word.starts_with("--") || word == "-h"; }

constexpr std::size_t widest_line = 100; // of --help, in columns
constexpr auto indent = "      ";        // of the help text below the name of its option

/// Breaks a text into lines that begin with `margin`.
std::string wrapped(const std::string& text, const char* margin) {
    std::istringstream words(text);
    std::string lines, line;
    for (std::string word; words >> word;) {
        if (!line.empty() && line.size() + 1 + word.size() > widest_line) {
            lines += line + "\n";
            line.clear();
        }
        line += (line.empty() ? margin : " ") + word;
    }
    return lines + line + "\n";
}

std::string capitalised(std::string text) {
    if (!text.empty())
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    return text;
}

/// A line of a config file without its comment; '#' within quotes does not begin a comment.
std::string without_comment(const std::string& line) {
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') quoted = !quoted;
        if (line[i] == '#' && !quoted) return line.substr(0, i);
    }
    return line;
}

} // namespace

void Options::add(Option option) {
    if (find(option.name))
        throw std::logic_error("option '" + option.name + "' is described twice");
    option.initially = option.text();
    options_.push_back(std::move(option));
}

std::string Options::Option::text() const {
    return std::visit(Overloaded{[](const std::vector<double>* x) {
                                     std::vector<std::string> texts;
                                     for (const double number : *x)
                                         texts.push_back(fmt::format("{}", number));
                                     return joined(texts, ",");
                                 },
                                 [](const std::filesystem::path* x) { return x->string(); },
                                 [&](const Choice& x) { return choices[x.get(x.value)]; },
                                 [](const auto* x) { return fmt::format("{}", *x); }},
                      target);
}

void Options::operator()(std::string name, double& value, std::string unit, std::string help,
                         Range range) {
    add({std::move(name), std::move(unit), std::move(help), &value, range, {}, {}});
}
void Options::operator()(std::string name, unsigned& value, std::string unit, std::string help,
                         Range range) {
    add({std::move(name), std::move(unit), std::move(help), &value, range, {}, {}});
}
void Options::operator()(std::string name, std::uint64_t& value, std::string unit, std::string help,
                         Range range) {
    add({std::move(name), std::move(unit), std::move(help), &value, range, {}, {}});
}
void Options::operator()(std::string name, std::vector<double>& value, std::string unit,
                         std::string help, Range range) {
    add({std::move(name), std::move(unit), std::move(help), &value, range, {}, {}});
}
void Options::operator()(std::string name, bool& value, std::string unit, std::string help) {
    add({std::move(name), std::move(unit), std::move(help), &value, {}, {}, {}});
}
void Options::operator()(std::string name, std::string& value, std::string unit, std::string help,
                         std::vector<std::string> choices) {
    add({std::move(name), std::move(unit), std::move(help), &value, {}, std::move(choices), {}});
}
void Options::operator()(std::string name, std::filesystem::path& value, std::string unit,
                         std::string help) {
    add({std::move(name), std::move(unit), std::move(help), &value, {}, {}, {}});
}

void Options::group(std::string title) { groups_.push_back({std::move(title), options_.size()}); }

const Options::Option* Options::find(const std::string& name) const {
    const auto found = std::find_if(options_.begin(), options_.end(),
                                    [&](const Option& option) { return option.name == name; });
    return found == options_.end() ? nullptr : &*found;
}

const Options::Option* Options::find_flag(const std::string& text) const {
    const auto found = std::ranges::find_if(
        options_, [&](const Option& option) { return flag(option.name) == text; });
    return found == options_.end() ? nullptr : &*found;
}

std::string Options::nearest(const std::string& name) const {
    std::string best;
    std::size_t least = std::max<std::size_t>(2, name.size() / 3) + 1;
    for (const Option& option : options_) {
        const std::size_t distance = edit_distance(name, option.name);
        if (distance < least) least = distance, best = option.name;
    }
    return best;
}

void Options::read_config(const std::filesystem::path& file) {
    std::istringstream in(read_text(file));
    std::string line;
    std::map<std::string, int> seen;
    for (int number = 1; std::getline(in, line); ++number) {
        const std::string at = fmt::format("{}:{}", file.string(), number);
        const std::string content = trimmed(without_comment(line));
        if (content.empty()) continue;
        const std::size_t equals = content.find('=');
        if (equals == std::string::npos) reject(at, "a line `name = value`", content);
        const std::string typed = trimmed(content.substr(0, equals));
        std::string name = typed, text = trimmed(content.substr(equals + 1));
        std::replace(name.begin(), name.end(), '-', '_');
        if (text.size() > 1 && text.front() == '"' && text.back() == '"')
            text = text.substr(1, text.size() - 2);
        if (name == "config") reject(at, "no other configuration file", typed);
        const Option* option = find(name);
        if (!option) {
            const std::string hint = nearest(name);
            reject(at, hint.empty() ? "the name of an option" : "an option such as " + hint, typed);
        }
        if (const auto [earlier, first] = seen.emplace(name, number); !first)
            throw InputError(fmt::format("{}: {}: expected once, found on line {} already", at,
                                         name, earlier->second));
        std::visit(Assign{at + ": " + name, text, option->unit, option->range, option->choices},
                   option->target);
    }
}

void Options::assign_flag(const Option& option, const Values& values) const {
    const std::string name = flag(option.name);
    if (values.size() > 1)
        throw InputError(fmt::format("{}: expected once, found {} times", name, values.size()));
    const bool is_switch = std::holds_alternative<bool*>(option.target);
    const std::string text = values.front().value_or(is_switch ? "true" : "");
    if (text.empty()) throw InputError(fmt::format("{}: expected a value, found nothing", name));
    std::visit(Assign{name, text, option.unit, option.range, option.choices}, option.target);
}

void Options::reject_unknown(const std::string& found) const {
    std::string name = found.substr(std::min(found.find_first_not_of('-'), found.size()));
    name = name.substr(0, name.find('='));
    std::replace(name.begin(), name.end(), '-', '_');
    const std::string hint = found.starts_with("-") ? nearest(name) : std::string{};
    throw InputError(fmt::format("expected an option, found \"{}\"{}", found,
                                 hint.empty() ? " (--help lists the options)"
                                              : "; did you mean " + flag(hint) + "?"));
}

std::vector<Options::Values> Options::split(const std::vector<std::string>& arguments) const {
    std::vector<Values> values(options_.size());
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string& word = arguments[i];
        const std::size_t equals = word.find('=');
        const Option* option = find_flag(word.substr(0, equals));
        if (!option) reject_unknown(word);
        Values& typed = values[static_cast<std::size_t>(option - options_.data())];
        if (equals != std::string::npos)
            typed.emplace_back(word.substr(equals + 1));
        else if (i + 1 < arguments.size() && !is_flag(arguments[i + 1]))
            typed.emplace_back(arguments[++i]);
        else
            typed.emplace_back();
    }
    return values;
}

Options::Request Options::parse(const std::vector<std::string>& arguments) {
    const auto among = [&](const char* word) { return std::ranges::count(arguments, word) > 0; };
    if (among("--help") || among("-h")) return Request::help;
    if (among("--version")) return Request::version;
    const std::vector<Values> values = split(arguments);
    for (std::size_t i = 0; i < options_.size(); ++i)
        if (options_[i].name == "config" && !values[i].empty()) {
            assign_flag(options_[i], values[i]);
            read_config(*values[i].front());
        }
    for (std::size_t i = 0; i < options_.size(); ++i)
        if (!values[i].empty()) assign_flag(options_[i], values[i]);
    return Request::run;
}

void Options::take(const std::vector<NamedValue>& settings, const std::string& where) {
    for (const Option& option : options_) {
        const std::string key = key_with_unit(option.name, option.unit);
        const auto found = std::ranges::find(settings, key, &NamedValue::key);
        if (found == settings.end()) continue;
        const std::string text = found->text();
        if (!text.empty())
            std::visit(Assign{where + ": " + key, text, option.unit, option.range, option.choices},
                       option.target);
    }
}

std::vector<std::string> Options::warnings() const {
    std::vector<std::string> list;
    const auto look_at = [&](const Option& option, double x) {
        if (is_usual(option.range, x)) return;
        const bool has_unit = !option.unit.empty() && option.unit != "-";
        list.push_back(fmt::format("{}: expected usually {:g} to {:g}{}, found {:g}{}",
                                   flag(option.name), option.range.usual_low,
                                   option.range.usual_high, has_unit ? " " + option.unit : "", x,
                                   has_unit ? hint_at_unit(option.range, x) : ""));
    };
    for (const Option& option : options_) {
        if (option.text() == option.initially) continue; // not set
        if (const auto* number = std::get_if<double*>(&option.target)) look_at(option, **number);
        if (const auto* numbers = std::get_if<std::vector<double>*>(&option.target))
            for (const double x : **numbers) look_at(option, x);
    }
    return list;
}

/// The flag and its value as --help shows them: "--step <s>", "--bodies <integer>", "--quiet".
std::string Options::heading(const Option& option) {
    const std::string number = option.unit.empty() || option.unit == "-" ? "number" : option.unit;
    const std::string value =
        std::visit(Overloaded{[&](const double*) { return number; },
                              [&](const std::vector<double>*) { return number + ",..."; },
                              [&](const bool*) { return std::string(); },
                              [&](const std::string*) {
                                  return std::string(option.choices.empty() ? "text" : "name");
                              },
                              [&](const std::filesystem::path*) { return std::string("path"); },
                              [&](const Choice&) { return std::string("name"); },
                              [&](const auto*) { return std::string("integer"); }},
                   option.target);
    return flag(option.name) + (value.empty() ? "" : fmt::format(" <{}>", value));
}

/// Range, choices and default as sentences that follow the help text.
std::string Options::notes(const Option& option) {
    std::string text;
    if (has_usual(option.range))
        text +=
            fmt::format(" Usually {:g} to {:g}.", option.range.usual_low, option.range.usual_high);
    if (const std::string range = words(option.range); !range.empty())
        text += fmt::format(" {}.", capitalised(range.substr(range.starts_with(" of ") ? 4 : 1)));
    if (!option.choices.empty()) text += fmt::format(" One of {}.", joined(option.choices, ", "));
    if (option.help.find("Default:") == std::string::npos)
        text += fmt::format(" Default: {}.", option.initially.empty() ? "none" : option.initially);
    return text;
}

std::string Options::help(const std::string& program, const std::string& description) const {
    std::string text =
        fmt::format("{}\nUsage: {} [--option value]...\n\n", wrapped(description, ""), program);
    for (std::size_t i = 0; i < options_.size(); ++i) {
        for (const Group& group : groups_)
            if (group.first == i)
                text += fmt::format("{}{}:\n", i > 0 ? "\n" : "", capitalised(group.title));
        const Option& option = options_[i];
        const bool has_end = option.help.empty() || option.help.ends_with('.');
        text += fmt::format("  {}\n{}", heading(option),
                            wrapped(option.help + (has_end ? "" : ".") + notes(option), indent));
    }
    const auto version = wrapped("Print the version of BRIS, the commit, the compiler, the "
                                 "instruction set and the versions of the libraries, and exit.",
                                 indent);
    text +=
        fmt::format("  --help, -h\n{}Print this help and exit.\n  --version\n{}", indent, version);
    text += "\nExit codes:\n";
    for (const auto& [code, meaning] : exit_codes)
        text += fmt::format("  {}\n{}", static_cast<int>(code), wrapped(meaning, indent));
    return text;
}

std::vector<NamedValue> Options::values() const {
    std::vector<NamedValue> list;
    for (const Option& option : options_) {
        const std::string key = key_with_unit(option.name, option.unit);
        std::visit(
            Overloaded{[&](const std::vector<double>*) { list.emplace_back(key, option.text()); },
                       [&](const std::filesystem::path*) { list.emplace_back(key, option.text()); },
                       [&](const Choice&) { list.emplace_back(key, option.text()); },
                       [&](const auto* x) { list.emplace_back(key, *x); }},
            option.target);
        list.back().flag = flag(option.name);
    }
    return list;
}

std::vector<Options::Change> Options::changes() const {
    std::vector<Change> list;
    for (const Option& option : options_)
        if (const std::string value = option.text(); value != option.initially)
            list.push_back({flag(option.name), key_with_unit(option.name, option.unit), value,
                            option.initially, option.help});
    return list;
}

std::string key_with_unit(const std::string& name, const std::string& unit) {
    if (unit.empty() || unit == "-") return name;
    std::string suffix;
    const std::string text = unit.starts_with("1/") ? unit.substr(1) : unit;
    for (const char c : text) {
        if (c == '/')
            suffix += suffix.empty() ? "per_" : "_per_";
        else if (c == '%')
            suffix += "percent";
        else if (std::isalnum(static_cast<unsigned char>(c)))
            suffix += c;
        else if (c == ' ' || c == '*')
            suffix += '_';
    }
    return name + "_" + suffix;
}

} // namespace bris
