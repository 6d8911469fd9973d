#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/monitoring/activity.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/stream/gate.hpp"

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace bris {

struct PassageStreamSettings {
    double window = 120; ///< s, longest passage
    double quiet = 5;    ///< s without vibration that end a passage
    double late = 21600; ///< s after a passage for which late records revise its verdict
    double timeout = 60; ///< s without a line after which the stream counts as ended
    double memory = 200; ///< MB of samples that wait, of all sensors
    VibrationQuantity quantity = VibrationQuantity::vertical;
    std::map<unsigned, double> thresholds; ///< m/s2 or rad/s by sensor, of a passing train
};

/// One passage as far as its records have come.
struct StreamPassage {
    std::uint64_t id = 0; ///< the same in all revisions
    unsigned revision = 1;
    bool is_final = false;     ///< no record of that time can come any more
    bool time_is_known = true; ///< false: nothing says when its one sensor recorded it
    std::vector<std::uint64_t> replaces = {}; ///< passages that turned out to be part of this one
    Passage passage = {};
};

/// What became of the records of a stream; received = in_passages + quiet + left out + waiting.
struct StreamCounts {
    std::uint64_t received = 0, in_passages = 0, quiet = 0, left_out = 0, lost = 0, waiting = 0;
};

/// Passages of trains in the records of SmartRocks that arrive as lines (RecordParser) and pass the
/// Gate. A passage begins with the first sensor that vibrates and ends when all are quiet; records
/// belong to the passage of their own corrected time, however late they come. It is given as soon
/// as the sensors that are alive have passed its end, again when late records change it, and once
/// more when it is final: all sensors have recorded its time, `late` is over, or the stream has
/// ended. {"end": 1} ends the stream. Pure function of the lines and their arrivals.
class PassageStream {
public:
    /// Throws OutputError if the source cannot be opened, InputError without a sensor.
    PassageStream(const std::filesystem::path& source, std::vector<SensorInfo> infos,
                  const PassageStreamSettings& settings);
    /// The same with lines from elsewhere, such as a broker.
    PassageStream(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                  const PassageStreamSettings& settings);
    /// The next passage; nothing: the stream has ended, and all passages were given. Throws
    /// Interrupted.
    std::optional<StreamPassage> next();
    /// Counts of what was received, and of what was not used with the first example of each kind.
    std::string report() const;
    StreamCounts counts() const;
    const Gate& gate() const { return gate_; }
    /// s of recorded time, of the sensor that recorded longest.
    double recorded_time() const;

private:
    /// What one sensor recorded of a passage.
    struct Activity {
        std::size_t segment = 0;
        PassageInterval own;          // unwrapped own time
        std::optional<double> offset; // to common time; nothing: not known so far
        Samples samples;
        std::uint64_t passage = 0; // that it was given in; 0: none
    };
    /// Records of one segment of a sensor's clock that are not in an activity.
    struct Open {
        Samples samples;
        // s, unwrapped own times: of those that are here, of all so far
        double latest = 0, newest = -1e300, looked_at = -1e300;
        double done = -1e300; // before it nothing is left of a passage
    };
    struct Sensor {
        SensorInfo info;
        ActivitySettings settings;
        std::map<std::size_t, Open> open = {}; // by segment
        std::deque<Activity> activities = {};
        double recorded = 0; // s
        double last = -1e300;
    };
    /// Activities that belong together, in common time.
    struct Group {
        PassageInterval time;
        std::vector<std::pair<Sensor*, Activity*>> members;
    };
    struct Given {
        unsigned revision = 0;
        std::size_t samples = 0;
        PassageInterval time;
    };
    void take(const Lines::Line& line);
    void keep(GatedRecord record);
    Open& open_segment(Sensor& sensor, std::size_t segment);
    void look(Sensor& sensor, std::size_t segment, Open& open, bool at_end);
    void close(Sensor& sensor, std::size_t segment, Open& open, const PassageInterval& passage);
    bool is_too_late(const Sensor& sensor, const Open& open, const GatedRecord& record) const;
    bool was_final(double common) const;
    void find_offsets();
    bool join(Sensor& sensor, std::size_t segment, const GatedRecord& record);
    void update();
    std::vector<Group> groups();
    void give(const Group& group, bool is_final);
    void give_unknown();
    double looked_through(const Sensor& sensor) const;
    bool is_complete(const Group& group) const;
    bool is_due(const Group& group) const;
    bool is_over_late(const Group& group) const;
    void release(const Group& group);
    void forget_released();
    void limit_memory();
    std::string name_of(double common) const;

    std::unique_ptr<Lines> lines_;
    RecordParser parser_{monitored_fields()};
    Gate gate_;
    PassageStreamSettings settings_;
    std::map<unsigned, Sensor> sensors_;
    std::deque<StreamPassage> ready_;
    std::map<std::uint64_t, Given> given_; // passages that are not final
    std::vector<PassageInterval> final_;   // common times of the last final ones, in order
    std::uint64_t taken_ = 0, unreadable_ = 0, passages_ = 0, in_passages_ = 0, quiet_ = 0;
    double updated_ = -1e300; // s, progress of the stream at the last update
    bool over_ = false;
};

} // namespace bris
