#include "engine/io/broker_history.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/arrival.hpp"
#include "engine/io/hdf5_content.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>
#include <utility>

namespace bris {

namespace {

constexpr std::uint64_t bytes_of_part = 2 << 20; // about; a reader holds one part, as doubles
constexpr std::size_t most_waiting = 1 << 18;    // bytes
constexpr double interval = 1;                   // s between writes
constexpr std::uint8_t retained_flag = 1, published_flag = 2;
constexpr std::size_t row_bytes = 17; // of the columns

std::uint64_t size_of(const KeptMessage& m) {
    return row_bytes + m.topic.size() + m.payload.size();
}

template <class T>
void append(Hdf5File& file, const std::string& dataset, const std::vector<T>& values) {
    file.append(dataset, std::span<const T>(values));
}

template <class T>
std::vector<T> whole_numbers(const Hdf5Content& content, const std::string& dataset) {
    const std::vector<double>& found = content.numbers(dataset);
    const auto fits = [](double x) {
        return x >= 0 && x <= std::numeric_limits<T>::max() && x == std::floor(x);
    };
    require(std::all_of(found.begin(), found.end(), fits),
            fmt::format("{}: {}: expected whole numbers from 0 to {}, found others",
                        content.path().string(), dataset, std::numeric_limits<T>::max()));
    return {found.begin(), found.end()};
}

} // namespace

BrokerHistory::BrokerHistory(Hdf5File& file, std::uint64_t most_bytes)
    : file_(file), most_bytes_(most_bytes) {
    file_.make_group("/broker");
    parts_ = static_cast<unsigned>(file_.names("/broker").size());
    part_bytes_ = bytes_of_part; // the first message begins a part
}

std::string BrokerHistory::in_part(const char* name) const {
    return fmt::format("/broker/part_{:06}/{}", parts_ - 1, name);
}

void BrokerHistory::begin_part() {
    ++parts_;
    part_bytes_ = 0;
    file_.make_growing<double>(in_part("time"), {}, 1024);
    file_.make_growing<std::uint8_t>(in_part("flags"), {}, 1024);
    file_.make_growing<std::uint32_t>(in_part("topic_bytes"), {}, 1024);
    file_.make_growing<std::uint32_t>(in_part("payload_bytes"), {}, 1024);
    file_.make_growing<std::uint8_t>(in_part("bytes"), {}, 1 << 16);
    file_.set_attribute(in_part("time"), "unit", std::string("s since 1970 UTC"));
}

void BrokerHistory::add(KeptMessage message) {
    if (closed_) return;
    const std::uint64_t size = size_of(message);
    if (bytes_ + size > most_bytes_) {
        ++left_out_;
        return;
    }
    bytes_ += size;
    waiting_bytes_ += size;
    waiting_.push_back(std::move(message));
    if (waiting_bytes_ >= most_waiting)
        flush();
    else
        write_if_due();
}

BrokerHistory::~BrokerHistory() {
    try {
        close();
    } catch (const OutputError&) { // only close() can report it
    }
}

void BrokerHistory::close() {
    if (!std::exchange(closed_, true)) flush();
}

void BrokerHistory::write_if_due() {
    if (!closed_ && !waiting_.empty() && seconds_since(written_) >= interval) flush();
}

void BrokerHistory::flush() {
    written_ = this_instant();
    if (waiting_.empty()) return;
    if (part_bytes_ >= bytes_of_part) begin_part();
    std::vector<double> times;
    std::vector<std::uint8_t> flags, bytes;
    std::vector<std::uint32_t> topic_bytes, payload_bytes;
    bytes.reserve(waiting_bytes_);
    for (const KeptMessage& m : waiting_) {
        times.push_back(m.time);
        flags.push_back(static_cast<std::uint8_t>((m.retained ? retained_flag : 0) |
                                                  (m.published ? published_flag : 0)));
        topic_bytes.push_back(static_cast<std::uint32_t>(m.topic.size()));
        payload_bytes.push_back(static_cast<std::uint32_t>(m.payload.size()));
        bytes.insert(bytes.end(), m.topic.begin(), m.topic.end());
        bytes.insert(bytes.end(), m.payload.begin(), m.payload.end());
    }
    append(file_, in_part("time"), times);
    append(file_, in_part("flags"), flags);
    append(file_, in_part("topic_bytes"), topic_bytes);
    append(file_, in_part("payload_bytes"), payload_bytes);
    append(file_, in_part("bytes"), bytes);
    part_bytes_ += waiting_bytes_;
    waiting_.clear();
    waiting_bytes_ = 0;
    file_.flush();
}

HistoryReader::HistoryReader(const std::filesystem::path& path) : path_(path) {
    const auto content = Hdf5Content::read(path, {"/broker"}, Hdf5Content::Datasets::left_out);
    require(content.has("/broker"),
            fmt::format("{}: expected a run file with the history of a broker (/broker), found "
                        "none in it",
                        path.string()));
    parts_ = content.names("/broker");
}

void HistoryReader::read_part() {
    const std::string part = "/broker/" + parts_[part_++];
    const auto content = Hdf5Content::read(path_, {part});
    times_ = content.numbers(part + "/time");
    flags_ = whole_numbers<std::uint8_t>(content, part + "/flags");
    topic_bytes_ = whole_numbers<std::uint32_t>(content, part + "/topic_bytes");
    payload_bytes_ = whole_numbers<std::uint32_t>(content, part + "/payload_bytes");
    bytes_ = whole_numbers<std::uint8_t>(content, part + "/bytes");
    row_ = place_ = 0;
    std::uint64_t sum = 0;
    for (const auto* sizes : {&topic_bytes_, &payload_bytes_})
        for (const std::uint32_t size : *sizes) sum += size;
    // a run that was killed may have written some columns further than others
    const std::size_t rows =
        std::min({times_.size(), flags_.size(), topic_bytes_.size(), payload_bytes_.size()});
    const bool whole = rows == times_.size() && rows == flags_.size() &&
                       rows == topic_bytes_.size() && rows == payload_bytes_.size() &&
                       sum == bytes_.size();
    require(whole || part_ == parts_.size(),
            fmt::format("{}: {}: expected columns of one length and {} bytes, found {}",
                        path_.string(), part, sum, bytes_.size()));
    times_.resize(rows);
}

std::optional<KeptMessage> HistoryReader::next() {
    while (row_ == times_.size()) {
        if (part_ == parts_.size()) return {};
        read_part();
    }
    const std::size_t topic = topic_bytes_[row_], payload = payload_bytes_[row_];
    if (place_ + topic + payload > bytes_.size()) { // the unfinished end of a run that was killed
        row_ = times_.size();
        return {};
    }
    const auto text = [&](std::size_t size) {
        const auto from = bytes_.begin() + static_cast<std::ptrdiff_t>(place_);
        place_ += size;
        return std::string(from, from + static_cast<std::ptrdiff_t>(size));
    };
    KeptMessage m{times_[row_], text(topic), {}};
    m.payload = text(payload);
    m.retained = (flags_[row_] & retained_flag) != 0;
    m.published = (flags_[row_] & published_flag) != 0;
    ++row_;
    return m;
}

bool is_hdf5(const std::filesystem::path& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return false;
    std::ifstream in(path, std::ios::binary);
    std::array<char, 8> head{};
    in.read(head.data(), head.size());
    return in && std::string_view(head.data(), head.size()) == "\211HDF\r\n\032\n";
}

RecordedLink::RecordedLink(BrokerLink& link, BrokerHistory& history)
    : link_(link), history_(history) {
    history_.add({arrival_now(), own_topic, "began"});
}

std::optional<BrokerMessage> RecordedLink::next(double timeout) {
    auto message = link_.next(timeout);
    if (message)
        history_.add({message->time, message->topic, message->payload, message->retained});
    else
        history_.write_if_due();
    return message;
}

bool RecordedLink::publish(const std::string& topic, const std::string& payload,
                           Delivery delivery) {
    history_.add({arrival_now(), topic, payload, delivery == Delivery::retained, true});
    return link_.publish(topic, payload, delivery);
}

ReplayedLink::ReplayedLink(const std::filesystem::path& path, double speed, BrokerLink* to)
    : reader_(path), speed_(speed), to_(to) {
    advance();
    if (coming_) first_ = coming_->time;
}

void ReplayedLink::advance() {
    do coming_ = reader_.next();
    while (coming_ && coming_->published);
}

std::optional<BrokerMessage> ReplayedLink::next(double timeout) {
    const Instant called = this_instant();
    const auto due = [&] {
        return speed_ <= 0 || !(coming_->time - first_ > speed_ * seconds_since(began_));
    };
    while (coming_ && !due()) {
        if (interrupted() || seconds_since(called) >= timeout) return {};
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    if (!coming_) return {};
    BrokerMessage m{std::move(coming_->topic), std::move(coming_->payload), coming_->retained,
                    this_instant(), coming_->time};
    advance();
    if (m.topic != own_topic)
        ++counters_.received;
    else if (m.payload == "broken")
        ++counters_.breaks;
    else if (m.payload == "session lost")
        ++counters_.lost_sessions;
    return m;
}

} // namespace bris
