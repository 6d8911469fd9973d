#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/recordings/record_stream.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// How a test is followed while it goes on.
struct LiveSettings {
    double pressure = 55e3; ///< Pa
    double timeout = 60; ///< s without a record of the test machine that can be used, after which
                         ///< the stream counts as ended; before its first: without any line
    double lateness = 0; ///< axial strain, by which the model waits for samples that come late
    double speed = 0;    ///< of a replay, by the records' t: 1 as fast as it was, 0 at once
    QualityControlSettings quality_control = {};
};

/// A triaxial test that is going on, as far as its records tell of it. A record with an `id` is a
/// SmartRock's: t, and of strain, phase, seq, flags, ax ..., gx ..., mx ..., ux ..., qw ..., temp,
/// batt what there is; without one it is the test machine's: axial_strain, deviatoric_stress_Pa,
/// and of t, phase, volumetric_strain, ring_1_radius_m ... what there is. A SmartRock's record
/// without strain gets that of the machine at its phase, or else at its t, less the clock_offset of
/// its metadata. Records may come late, out of order and twice. What cannot be used is let be,
/// counted and reported; a sensor, or a channel of the machine, is left out as long as its records
/// so far do not pass the intake. {"end": 1} ends it.
///
/// All lines that came are kept in a log, in the order in which they are taken: the same lines give
/// the same test, bit for bit, and a run that was stopped takes those of its log first, one by one
/// as before. Only a sender ends a test for good; after silence it can be gone on with.
class LiveTest {
public:
    /// Lines of a log that is there already come first. Throws OutputError, and InputError where
    /// there is no sensor.
    LiveTest(const std::filesystem::path& stream, std::filesystem::path log,
             std::vector<SensorInfo> infos, const LiveSettings& settings);
    ~LiveTest();
    LiveTest(const LiveTest&) = delete;

    /// Takes records until the machine has passed an axial strain, and `lateness` more; waits for
    /// them. False: the stream has ended before.
    bool follow_to(double strain);
    /// The test by all records taken, checked.
    RecordedTest so_far() const;
    std::uint64_t lines_taken() const { return taken_; }
    /// Whether the stream has ended.
    bool over() const { return over_; }
    /// s, from the arrival of each record taken since the last call to now; those of an earlier
    /// run's log are not among them.
    std::vector<double> ages();
    /// What was found in the stream, a line for each kind of thing, and what the intake found.
    std::string report() const;

private:
    /// What a SmartRock sent at one t: the numbers of a record by their places (sample_names), and
    /// by bits which of them.
    struct Sample {
        std::array<double, 22> numbers;
        std::uint32_t sent;
    };
    struct SensorRecords {
        std::map<double, Sample> by_time;
        std::uint32_t sent = 0; ///< in any of them
        std::uint64_t late = 0, twice = 0;
        double clock_offset = 0;   ///< s, as given
        std::vector<double> ahead; ///< s, of its t when each came, of the machine's last
    };
    void take_line(LineSource::Line line, bool from_log);
    std::optional<LineSource::Line> next_of_log();
    void write_to_log(std::string_view text);
    void take(const StreamRecord& record);
    void take_of_sensor(const StreamRecord& record);
    void take_of_machine(const StreamRecord& record);
    void accept(const StreamRecord& record);
    void wait_for_its_time(StreamRecord& record);
    void end(const std::string& why, bool by_sender);
    bool is_far_off(const StreamRecord& record, const char* who, double strain);
    void note(const std::string& kind, const std::string& text);
    static Sample sample_of(const StreamRecord& record);
    void look_for_numbers(const StreamRecord& record);
    double strain_of(double t, const Sample& sample) const;
    Recording recording_of(const SensorInfo& info) const;
    void check_clocks(RecordedTest& test) const;
    std::optional<double> clock_ahead(const SensorRecords& sensor) const;
    TriaxialPoint point_of(const StreamRecord& record) const;

    LineSource lines_;
    RecordParser parser_;
    std::FILE* log_ = nullptr;
    std::deque<std::string> logged_; // not taken yet
    std::vector<SensorInfo> infos_;
    LiveSettings settings_;
    std::map<unsigned, SensorRecords> sensors_;
    std::map<double, StreamRecord> machine_; // by axial strain
    MachineClock clock_;                     // by the machine's t and phase
    std::map<std::string, std::pair<std::uint64_t, std::string>> notes_; // how often, and the first
    std::vector<StreamRecord>
        inconsistent_; // of the machine, far from what it said before, near each other
    std::vector<Instant> arrivals_;
    std::uint64_t taken_ = 0;
    double followed_ = 0, first_t_ = 0;
    Instant began_, waiting_since_;
    bool over_ = false, begun_ = false;
};

} // namespace bris
