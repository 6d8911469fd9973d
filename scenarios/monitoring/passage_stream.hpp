#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/stream/record_stream.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace bris {

struct PassageStreamSettings {
    double window = 60;  ///< s of recorded time in a passage
    double late = 2;     ///< s of recorded time for which a window waits for late records
    double timeout = 60; ///< s without a line after which the stream counts as ended
};

/// Records of SmartRocks that arrive as lines (RecordParser), cut into windows of recorded time by
/// t less the clock_offset of the metadata. Records may arrive late, out of order and twice; those
/// of a window that was closed, and lines that cannot be used, are counted and reported. A window
/// closes when the median sensor has passed its end; the first one begins `late` before the first
/// record. {"end": 1} ends the stream.
class PassageStream {
public:
    /// Throws OutputError if the source cannot be opened, InputError without a sensor.
    PassageStream(const std::filesystem::path& source, std::vector<SensorInfo> infos,
                  const PassageStreamSettings& settings);
    /// The same with lines from elsewhere, such as a broker.
    PassageStream(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                  const PassageStreamSettings& settings);
    /// The next window with records, with a recording for each sensor; nothing: the stream has
    /// ended. Throws Interrupted.
    std::optional<Passage> next();
    /// Whether the stream has ended and all its windows were taken.
    bool over() const;
    /// Number of lines, and of those that were not used with the first reason of each kind.
    std::string report() const;

private:
    using Samples = std::map<double, StreamRecord>; // by the sensor's t
    void take(const LineSource::Line& line);
    void take_record(StreamRecord record);
    double reached() const;
    Passage close_window();
    Recording recording_of(const SensorInfo& info, double end);
    void note(const std::string& kind, const std::string& text);

    std::unique_ptr<Lines> lines_;
    RecordParser parser_;
    std::vector<SensorInfo> infos_;
    PassageStreamSettings settings_;
    std::map<unsigned, Samples> samples_;
    std::map<unsigned, double> last_; // latest time of each sensor heard in the window
    std::map<std::string, std::pair<std::uint64_t, std::string>> notes_;
    std::optional<double> origin_; // beginning of the first window
    double begin_ = 0;             // of the window
    std::uint64_t taken_ = 0;
    bool over_ = false;
};

} // namespace bris
