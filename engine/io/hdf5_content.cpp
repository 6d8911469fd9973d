#include "engine/io/hdf5_content.hpp"

#include "engine/errors.hpp"
#include "engine/io/limited_child.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <system_error>

namespace bris {

namespace {

using Entry = Hdf5Content::Entry;
using Pipe = LimitedChild::Pipe;

constexpr int deepest = 2;

/// Calls an action that reads; returns why it failed, or nothing.
template <class Action>
std::string reason_of(Action&& action) {
    try {
        action();
        return {};
    } catch (const OutputError& error) {
        return error.what();
    }
}

// what passes through the pipe: sizes, then values

void send(Pipe& pipe, const void* values, std::uint64_t count, std::size_t bytes_each) {
    pipe.write(&count, sizeof count);
    pipe.write(values, count * bytes_each);
}

void send(Pipe& pipe, const std::string& name, const Entry& entry) {
    for (const std::string* text : {&name, &entry.text, &entry.no_numbers, &entry.no_text})
        send(pipe, text->data(), text->size(), 1);
    send(pipe, entry.shape.data(), entry.shape.size(), sizeof(std::uint64_t));
    send(pipe, entry.numbers.data(), entry.numbers.size(), sizeof(double));
}

/// Receives what was sent, never more than `most` bytes altogether: the memory of the child may be
/// damaged.
class Receiver {
public:
    Receiver(LimitedChild& child, std::uint64_t most) : child_(child), left_(most) {}

    template <class List>
    void receive(List& list) {
        std::uint64_t count = 0;
        child_.read(&count, sizeof count);
        const std::uint64_t most = left_ / sizeof(list[0]);
        if (count > most) throw OutputError("it holds more than ten times its size and 64 MiB");
        list.resize(count);
        left_ -= count * sizeof(list[0]);
        child_.read(list.data(), count * sizeof(list[0]));
    }
    void receive(Entry& entry) {
        for (std::string* text : {&entry.text, &entry.no_numbers, &entry.no_text}) receive(*text);
        receive(entry.shape);
        receive(entry.numbers);
    }

private:
    LimitedChild& child_;
    std::uint64_t left_;
};

// the work of the child

void send_attributes(const Hdf5File& file, const std::string& object, Pipe& pipe) {
    for (const std::string& name : file.attribute_names(object)) {
        Entry entry;
        entry.no_numbers = reason_of([&] { entry.numbers = file.attribute<double>(object, name); });
        entry.no_text = reason_of([&] { entry.text = file.text_attribute(object, name); });
        send(pipe, object + "@" + name, entry);
    }
}

void send_object(const Hdf5File& file, const std::string& object, int depth,
                 Hdf5Content::Datasets datasets, Pipe& pipe) {
    Entry entry;
    if (!file.is_group(object)) {
        if (datasets == Hdf5Content::Datasets::included)
            entry.no_numbers = reason_of([&] {
                entry.shape = file.shape(object);
                entry.numbers = file.read<double>(object);
            });
        send(pipe, object, entry);
        send_attributes(file, object, pipe);
        return;
    }
    entry.no_numbers = fmt::format("cannot read {} in '{}': not an array of numbers", object,
                                   file.path().string());
    std::vector<std::string> names;
    entry.no_text = reason_of([&] { names = file.names(object); });
    send(pipe, object, entry);
    send_attributes(file, object, pipe);
    if (depth < deepest)
        for (const std::string& name : names)
            send_object(file, object + "/" + name, depth + 1, datasets, pipe);
}

void send_groups(const std::filesystem::path& path, const std::vector<std::string>& groups,
                 Hdf5Content::Datasets datasets, Pipe& pipe) {
    Entry whole; // the last entry, without a name: whether the file could be read
    whole.no_numbers = reason_of([&] {
        const Hdf5File file = Hdf5File::open(path);
        for (const std::string& group : groups)
            if (file.has(group)) send_object(file, group, 0, datasets, pipe);
    });
    send(pipe, "", whole);
}

} // namespace

Hdf5Content Hdf5Content::read(const std::filesystem::path& path,
                              const std::vector<std::string>& groups, Datasets datasets) {
    require_regular_file(path);
    std::error_code error; // a file that is not there is reported by who opens it
    const auto found = std::filesystem::file_size(path, error);
    const std::uint64_t size = error ? 0 : found, most = 10 * size + (std::uint64_t{64} << 20);
    Hdf5File::initialise();
    Hdf5Content content;
    content.path_ = path;
    LimitedChild child({.bytes = most, .seconds = 1 + static_cast<unsigned>(size / 20'000'000)},
                       [&](Pipe& pipe) { send_groups(path, groups, datasets, pipe); });
    std::string why;
    try {
        Receiver receiver(child, most);
        while (true) {
            std::string name;
            Entry entry;
            receiver.receive(name);
            receiver.receive(entry);
            if (name.empty()) {
                why = entry.no_numbers;
                break;
            }
            content.entries_.insert_or_assign(name, std::move(entry));
        }
    } catch (const OutputError& problem) {
        throw OutputError(fmt::format("cannot read '{}': {}", path.string(), problem.what()));
    }
    if (!why.empty()) throw OutputError(why);
    return content;
}

std::vector<std::string> Hdf5Content::names(const std::string& group) const {
    if (const Entry& own = entry(group); !own.no_text.empty()) throw OutputError(own.no_text);
    std::vector<std::string> list;
    const std::string prefix = group + "/";
    for (auto at = entries_.lower_bound(prefix);
         at != entries_.end() && at->first.starts_with(prefix); ++at)
        if (at->first.find_first_of("/@", prefix.size()) == std::string::npos)
            list.push_back(at->first.substr(prefix.size()));
    return list;
}

const Entry& Hdf5Content::entry(const std::string& name) const {
    const auto at = entries_.find(name);
    if (at == entries_.end())
        throw OutputError(
            fmt::format("cannot open {} in '{}': it does not exist", name, path_.string()));
    return at->second;
}

const Hdf5File::Shape& Hdf5Content::shape(const std::string& dataset) const {
    const Entry& found = entry(dataset);
    if (!found.no_numbers.empty()) throw OutputError(found.no_numbers);
    return found.shape;
}

const std::vector<double>& Hdf5Content::numbers(const std::string& dataset) const {
    const Entry& found = entry(dataset);
    if (!found.no_numbers.empty()) throw OutputError(found.no_numbers);
    return found.numbers;
}

bool Hdf5Content::has_attribute(const std::string& object, const std::string& name) const {
    return has(object + "@" + name);
}

std::vector<std::string> Hdf5Content::attribute_names(const std::string& object) const {
    std::vector<std::string> list;
    const std::string prefix = object + "@";
    for (auto at = entries_.lower_bound(prefix);
         at != entries_.end() && at->first.starts_with(prefix); ++at)
        list.push_back(at->first.substr(prefix.size()));
    return list;
}

bool Hdf5Content::has_text(const std::string& object, const std::string& attribute) const {
    return has_attribute(object, attribute) && entry(object + "@" + attribute).no_text.empty();
}

const std::vector<double>& Hdf5Content::attribute(const std::string& object,
                                                  const std::string& name) const {
    return numbers(object + "@" + name);
}

const std::string& Hdf5Content::text_attribute(const std::string& object,
                                               const std::string& name) const {
    const Entry& found = entry(object + "@" + name);
    if (!found.no_text.empty()) throw OutputError(found.no_text);
    return found.text;
}

} // namespace bris
