#include "engine/options.hpp"

#include "engine/errors.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <stdexcept>

namespace bris {

namespace {

template <class... Fs>
struct Overloaded : Fs... {
    using Fs::operator()...;
};

std::string flag(std::string name) {
    std::replace(name.begin(), name.end(), '_', '-');
    return "--" + name;
}

std::string trimmed(const std::string& text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The whole text as a number, or false.
template <class T>
bool read_number(std::string_view text, T& value) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc{} && stop == end && !text.empty();
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
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

/// " above 0", " from 0 to 1", or nothing.
std::string words(const Range& range) {
    const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
    if (low && high) {
        const auto end = [](bool accepted) { return accepted ? "" : " (excluded)"; };
        return fmt::format(" from {}{} to {}{}", range.low, end(range.low_accepted), range.high,
                           end(range.high_accepted));
    }
    if (low) return fmt::format(" {} {}", range.low_accepted ? "of at least" : "above", range.low);
    if (high)
        return fmt::format(" {} {}", range.high_accepted ? "of at most" : "below", range.high);
    return {};
}

std::string in_unit(const std::string& unit) {
    return unit.empty() || unit == "-" ? "" : fmt::format(" ({})", unit);
}

[[noreturn]] void reject(const std::string& where, const std::string& expected,
                         const std::string& found) {
    throw InputError(fmt::format("{}: expected {}, found \"{}\"", where, expected, found));
}

/// Sets one member from its text; `where` begins the message if that fails.
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

private:
    template <class T>
    void whole(T* value) const {
        T x = 0;
        if (!read_number(text, x) || !contains(range, static_cast<double>(x)))
            reject(where, "a whole number" + words(range) + in_unit(unit), text);
        *value = x;
    }
};

/// The value of a member as text, as a user would type it.
std::string written(const auto& target) {
    return std::visit(Overloaded{[](const std::vector<double>* x) {
                                     std::vector<std::string> texts;
                                     for (const double number : *x)
                                         texts.push_back(fmt::format("{}", number));
                                     return joined(texts, ",");
                                 },
                                 [](const std::filesystem::path* x) { return x->string(); },
                                 [](const auto* x) { return fmt::format("{}", *x); }},
                      target);
}

/// Letters to insert, delete or replace to turn one word into the other.
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

/// A line of a config file without its comment; '#' inside quotes stays.
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
    if (find(option.name)) throw std::logic_error("option '" + option.name + "' described twice");
    option.initially = written(option.target);
    options_.push_back(std::move(option));
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
    std::ifstream in(file);
    std::string line;
    if (!in || !std::filesystem::is_regular_file(file))
        throw OutputError(fmt::format("cannot read config file '{}'", file.string()));
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
        const Option* option = name == "config" ? nullptr : find(name);
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
    if (in.bad()) throw OutputError(fmt::format("cannot read config file '{}'", file.string()));
}

void Options::assign_flag(const Option& option, const std::vector<std::string>& texts) const {
    const std::string name = flag(option.name);
    if (texts.size() > 1)
        throw InputError(fmt::format("{}: expected once, found {} times", name, texts.size()));
    const bool is_switch = std::holds_alternative<bool*>(option.target);
    const std::string text = texts.front().empty() && is_switch ? "true" : texts.front();
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

bool Options::parse(const std::vector<std::string>& arguments) {
    CLI::App app;
    app.set_help_flag();
    app.allow_extras();
    bool help_wanted = false;
    app.add_flag("-h,--help", help_wanted);
    std::vector<std::vector<std::string>> typed(options_.size());
    std::vector<CLI::Option*> flags;
    for (std::size_t i = 0; i < options_.size(); ++i) {
        flags.push_back(app.add_option(flag(options_[i].name), typed[i])->expected(0, 1));
        flags.back()->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        flags.back()->allow_extra_args(false);
    }
    try {
        // CLI11 takes them from the back
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        throw InputError(error.what());
    }
    if (help_wanted) return false;
    if (const auto extras = app.remaining(); !extras.empty()) reject_unknown(extras.front());
    for (std::size_t i = 0; i < options_.size(); ++i) {
        typed[i].resize(flags[i]->count()); // a flag without a value leaves no text
        if (options_[i].name == "config" && !typed[i].empty()) {
            assign_flag(options_[i], typed[i]);
            read_config(typed[i].front());
        }
    }
    for (std::size_t i = 0; i < options_.size(); ++i)
        if (!typed[i].empty()) assign_flag(options_[i], typed[i]);
    return true;
}

std::string Options::help(const std::string& program, const std::string& description) const {
    std::string text = fmt::format("{}\n\nusage: {} [--option value]...\n", description, program);
    std::size_t widest = 0;
    for (const Option& option : options_) widest = std::max(widest, option.name.size());
    for (std::size_t i = 0; i < options_.size(); ++i) {
        for (const Group& group : groups_)
            if (group.first == i) text += fmt::format("\n{}\n", group.title);
        const Option& option = options_[i];
        std::vector<std::string> notes;
        if (!option.unit.empty()) notes.push_back(option.unit);
        if (const std::string range = words(option.range); !range.empty())
            notes.push_back(range.substr(1));
        if (!option.choices.empty()) notes.push_back("one of " + joined(option.choices, ", "));
        notes.push_back("default " + (option.initially.empty() ? "none" : option.initially));
        text += fmt::format("  {:<{}}  {} [{}]\n", flag(option.name), widest + 2, option.help,
                            joined(notes, "; "));
    }
    return text;
}

std::vector<NamedValue> Options::values() const {
    std::vector<NamedValue> list;
    for (const Option& option : options_) {
        const std::string key = key_with_unit(option.name, option.unit);
        std::visit(
            Overloaded{
                [&](const std::vector<double>*) { list.emplace_back(key, written(option.target)); },
                [&](const std::filesystem::path* x) { list.emplace_back(key, x->string()); },
                [&](const auto* x) { list.emplace_back(key, *x); }},
            option.target);
    }
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
