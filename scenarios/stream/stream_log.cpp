#include "scenarios/stream/stream_log.hpp"

#include "engine/errors.hpp"
#include "engine/io/base64.hpp"
#include "engine/io/json_members.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/printable.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace bris {

namespace {

constexpr std::string_view format = "bris stream log 1";

const char* name_of(LoggedRecords records) {
    return records == LoggedRecords::lines ? "lines" : "messages";
}

std::string member(std::string_view name, std::string_view text) {
    if (const auto string = json_string(text)) return fmt::format(", \"{}\": {}", name, *string);
    return fmt::format(", \"{}_base64\": \"{}\"", name, to_base64(text));
}

std::string text_of(const LogEntry& e) {
    std::string members;
    if (std::isfinite(e.arrival)) members += fmt::format(", \"arrival\": {}", e.arrival);
    switch (e.kind) {
    case LogEntry::Kind::session:
        break; // StreamLog writes them
    case LogEntry::Kind::line:
        members += member("line", e.text) + (e.whole ? "" : ", \"cut\": 1");
        break;
    case LogEntry::Kind::message:
    case LogEntry::Kind::published:
        members += member("topic", e.topic) + member("payload", e.text);
        if (e.retained) members += ", \"retained\": 1";
        if (e.kind == LogEntry::Kind::published) members += ", \"published\": 1";
        break;
    case LogEntry::Kind::tick:
        members += ", \"tick\": 1";
    }
    return "{" + members.substr(2) + "}\n";
}

/// Bytes of a file up to the end of its last whole line.
std::uint64_t whole_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary | std::ios::ate);
    std::uint64_t end = static_cast<std::uint64_t>(in.tellg());
    for (; end > 0; --end) {
        in.seekg(static_cast<std::streamoff>(end - 1));
        if (in.get() == '\n') break;
    }
    if (!in) throw OutputError(fmt::format("cannot read '{}'", path.string()));
    return end;
}

} // namespace

StreamLog::StreamLog(std::filesystem::path path, LoggedRecords records, std::uint64_t most_bytes)
    : path_(std::move(path)), began_(arrival_now()), most_(most_bytes) {
    const auto file = file_to_write(path_);
    if (std::filesystem::exists(file)) {
        earlier_ = whole_bytes(file);
        if (earlier_ > 0) (void)StreamLogReader(file); // throws if it is something else
        std::filesystem::resize_file(file, earlier_);
    } else if (file.has_parent_path()) {
        std::filesystem::create_directories(file.parent_path());
    }
    bytes_ = earlier_;
    file_ = std::fopen(file.c_str(), "ae");
    if (file_ == nullptr) throw OutputError(fmt::format("cannot write '{}'", path_.string()));
    write(fmt::format("{{\"format\": \"{}\", \"records\": \"{}\", \"arrival\": {}, \"anchor\": {}, "
                      "\"boot\": \"{}\"}}\n",
                      format, name_of(records), began_, arrival_anchor(), boot_of_computer()));
}

StreamLog::~StreamLog() {
    if (file_ != nullptr) (void)std::fclose(file_); // all is written
}

void StreamLog::close() {
    if (file_ != nullptr) (void)std::fclose(std::exchange(file_, nullptr));
}

void StreamLog::add(const LogEntry& entry) {
    if (file_ == nullptr) return;
    const std::string text = text_of(entry);
    // what came after something that is left out is left out too, or a replay would skip it
    if (left_out_ > 0 || bytes_ + text.size() > most_)
        ++left_out_;
    else
        write(text);
}

void StreamLog::write(const std::string& text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), file_) == text.size();
    if (std::fflush(file_) != 0 || !written)
        throw OutputError("cannot write the log of the stream: is the disk full?");
    bytes_ += text.size();
}

StreamLogReader::StreamLogReader(const std::filesystem::path& path, std::uint64_t until)
    : path_(path), line_(longest, '\0'), until_(until) {
    require_regular_file(path);
    in_.open(path, std::ios::binary);
    if (!in_) throw OutputError(fmt::format("cannot read '{}'", path.string()));
    try {
        first_ = next();
    } catch (const InputError&) { // any other file
    }
    require(first_ && first_->kind == LogEntry::Kind::session,
            fmt::format("{}: expected a log of a stream, \"{}\" in its first line, found something "
                        "else",
                        path.string(), format));
}

void StreamLogReader::refuse(const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", path_.string(), number_, why));
}

std::optional<LogEntry> StreamLogReader::next() {
    if (first_) return std::exchange(first_, {});
    ++number_;
    in_.getline(line_.data(), static_cast<std::streamsize>(line_.size()));
    const auto count = static_cast<std::uint64_t>(in_.gcount());
    place_ += count;
    if (in_.eof() || place_ > until_) return {};
    if (!in_) refuse(fmt::format("expected a line of less than {} bytes, found more", longest));
    return parse(std::string_view(line_).substr(0, count - 1));
}

LogEntry StreamLogReader::parse(std::string_view line) {
    using Kind = LogEntry::Kind;
    LogEntry e;
    std::optional<Kind> kind;
    const auto number = [&](const JsonMembers::Member& m) {
        const auto found = json_number(m.value);
        if (!found || !std::isfinite(*found))
            refuse(fmt::format("{}: expected a number, found {}", m.name, beginning_of(m.value)));
        return *found;
    };
    const auto text = [&](const JsonMembers::Member& m) {
        auto found = json_text(m.value);
        if (found && m.name.ends_with("_base64")) found = from_base64(*found);
        if (!found)
            refuse(fmt::format("{}: expected a text, found {}", m.name, beginning_of(m.value)));
        return std::move(*found);
    };
    bool published = false;
    JsonMembers members(line);
    const auto next_member = [&] {
        try {
            return members.next();
        } catch (const InputError& error) {
            refuse(error.what());
        }
    };
    while (const auto m = next_member()) {
        if (m->name == "arrival") {
            e.arrival = number(*m);
        } else if (m->name == "anchor") {
            e.anchor = number(*m);
        } else if (m->name == "boot") {
            e.boot = text(*m);
        } else if (m->name == "format") {
            if (text(*m) != format)
                refuse(fmt::format("format: expected \"{}\", found {}", format,
                                   beginning_of(m->value)));
            kind = Kind::session;
        } else if (m->name == "records" && number_ == 1) {
            records_ = text(*m) == "lines" ? LoggedRecords::lines : LoggedRecords::messages;
        } else if (m->name == "line" || m->name == "line_base64") {
            kind = Kind::line;
            e.text = text(*m);
        } else if (m->name == "topic" || m->name == "topic_base64") {
            kind = Kind::message;
            e.topic = text(*m);
        } else if (m->name == "payload" || m->name == "payload_base64") {
            e.text = text(*m);
        } else if (m->name == "tick") {
            kind = Kind::tick;
        } else if (m->name == "cut") {
            e.whole = number(*m) == 0;
        } else if (m->name == "retained") {
            e.retained = number(*m) != 0;
        } else if (m->name == "published") {
            published = number(*m) != 0;
        }
    }
    if (!kind) refuse("expected a line, a topic or a tick, found none");
    e.kind = *kind == Kind::message && published ? Kind::published : *kind;
    return e;
}

ArrivalsBefore arrivals_in(const std::filesystem::path& log) {
    ArrivalsBefore found;
    StreamLogReader reader(log);
    while (const auto e = reader.next()) {
        if (e->kind == LogEntry::Kind::session) {
            found.anchor = e->anchor;
            found.boot = e->boot;
        } else if (e->kind != LogEntry::Kind::published && std::isfinite(e->arrival)) {
            found.last = e->arrival;
        }
    }
    return found;
}

std::optional<LoggedRecords> records_of_log(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return {};
    std::string head(64, '\0');
    std::ifstream in(path, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    require(!head.starts_with("\211HDF\r\n\032\n"),
            fmt::format("{}: expected lines, or the log of a run (stream.ndjson), found an HDF5 "
                        "file; histories in run files of earlier versions are not read any more",
                        path.string()));
    if (!head.starts_with(fmt::format("{{\"format\": \"{}\"", format))) return {};
    return StreamLogReader(path).records();
}

} // namespace bris
