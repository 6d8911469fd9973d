#pragma once

#include "engine/io/broker_link.hpp"
#include "engine/io/hdf5.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// A message of a history.
struct KeptMessage {
    double time = 0; ///< s since 1970 UTC, of its arrival or publication
    std::string topic, payload;
    bool retained = false, published = false; ///< published by BRIS, or received
};

/// Writes what passed over a link to a broker into a run file, under /broker. Its parts,
/// part_000000 ..., have for each message its time, flags (1: retained, 2: published), topic_bytes
/// and payload_bytes; topics and payloads follow one another in `bytes`. What is older than a
/// second is on the disk. Members throw OutputError.
class BrokerHistory {
public:
    /// Goes on with the history that the file has. `most_bytes`: of all messages; more are left out
    /// and counted. The file has to live longer.
    BrokerHistory(Hdf5File& file, std::uint64_t most_bytes);
    ~BrokerHistory(); ///< writes what waits; an error is lost here, so writers call close()
    BrokerHistory(const BrokerHistory&) = delete;
    void add(KeptMessage message);
    void write_if_due(); ///< what waits, if it has waited for a second
    /// Writes what waits. What is added later is lost, as the file may be closed.
    void close();
    std::uint64_t left_out() const { return left_out_; } ///< messages

private:
    void flush();
    void begin_part();
    std::string in_part(const char* name) const;

    Hdf5File& file_;
    std::uint64_t most_bytes_, bytes_ = 0, left_out_ = 0, part_bytes_ = 0;
    unsigned parts_ = 0;
    bool closed_ = false;
    std::vector<KeptMessage> waiting_;
    std::size_t waiting_bytes_ = 0;
    Instant written_ = this_instant();
};

/// Reads the history of a run file, part by part, each in a child process, as users may bring such
/// files.
class HistoryReader {
public:
    /// Throws OutputError if the file cannot be read, InputError if it has no history.
    explicit HistoryReader(const std::filesystem::path& path);
    /// The next message; nothing: there are no more. Throws OutputError, and InputError for a part
    /// with other numbers than a history has, or whose sizes do not fit each other.
    std::optional<KeptMessage> next();

private:
    void read_part();

    std::filesystem::path path_;
    std::vector<std::string> parts_;
    std::size_t part_ = 0, row_ = 0, place_ = 0;
    std::vector<double> times_;
    std::vector<std::uint8_t> flags_, bytes_;
    std::vector<std::uint32_t> topic_bytes_, payload_bytes_;
};

/// Whether a file is HDF5, so that a history may be in it, and no lines of text.
bool is_hdf5(const std::filesystem::path& path);

/// A link whose messages, both ways, are kept.
class RecordedLink : public BrokerLink {
public:
    /// Link and history have to live longer. The history notes that a run began.
    RecordedLink(BrokerLink& link, BrokerHistory& history);
    std::optional<BrokerMessage> next(double timeout) override;
    bool over() const override { return link_.over(); }
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override;
    BrokerCounters counters() const override { return link_.counters(); }

private:
    BrokerLink& link_;
    BrokerHistory& history_;
};

/// What a run received from a broker, again.
class ReplayedLink : public BrokerLink {
public:
    /// `speed`: relative to the times of arrival; 0: at once. `to`: where publications go; null:
    /// nowhere; it has to live longer. Throws like HistoryReader.
    ReplayedLink(const std::filesystem::path& path, double speed, BrokerLink* to);
    std::optional<BrokerMessage> next(double timeout) override;
    bool over() const override { return !coming_; }
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override {
        return to_ == nullptr || to_->publish(topic, payload, delivery);
    }
    BrokerCounters counters() const override { return counters_; }

private:
    void advance();

    HistoryReader reader_;
    double speed_, first_ = 0; // s, of the first message
    BrokerLink* to_;
    std::optional<KeptMessage> coming_;
    Instant began_ = this_instant();
    BrokerCounters counters_;
};

} // namespace bris
