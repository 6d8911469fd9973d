#pragma once

#include "engine/io/line_source.hpp"
#include "scenarios/ensemble/machine_times.hpp"
#include "scenarios/ensemble/machine_track.hpp"
#include "scenarios/ensemble/sensor_records.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/stream/record_stream.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace bris {

/// Settings of a test that is followed while it goes on.
struct LiveSettings {
    double pressure = 55e3; ///< Pa
    /// s without a usable record of the test machine after which the stream counts as ended; before
    /// its first record: without any line.
    double timeout = 60;
    /// Axial strain by which the analysis stays behind the test, to wait for late samples.
    double analysis_delay = 0;
    /// Speed of a replay, by the t of the records: 1: that of the test, 0: as fast as possible.
    double speed = 0;
    QualityControlSettings quality_control = {};
};

/// A triaxial test in progress, as far as its records describe it. A record with an `id` is a
/// SmartRock's: t, and whichever of strain, phase, seq, flags, ax ..., gx ..., mx ..., ux ...,
/// qw ..., temp, batt it has. A record without one is the test machine's: axial_strain,
/// deviatoric_stress_Pa, and whichever of t, phase, volumetric_strain, ring_1_radius_m ... it has.
/// A SmartRock's record without strain is given the machine's strain at its phase, or else at its t
/// less the clock_offset of its metadata. Records may arrive late, out of order and twice. Those of
/// SmartRocks pass the Gate, so that clocks and counts may wrap, begin again and be set: what a
/// clock recorded after that is placed by its strains, or else by its arrival, or else left out as
/// of unknown time. Records that cannot be used are skipped, counted and reported; a sensor, or a
/// channel of the machine, is left out while its records so far fail quality control. {"end": 1}
/// ends the test.
///
/// The same lines give the same test, bit for bit: one that is logged (LoggedLines) can be
/// replayed, and a resumed run first processes those of its log, one by one as before. Only the
/// sender can end a test for good; after a timeout it can be resumed.
class LiveTest {
public:
    /// Throws InputError if there is no sensor.
    LiveTest(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
             const LiveSettings& settings);
    LiveTest(const LiveTest&) = delete;

    /// Processes records, and waits for them, until the machine has passed an axial strain plus
    /// `analysis_delay`. Returns false if the stream ended before that strain.
    bool follow_to(double strain);
    /// The test by all records processed, after quality control.
    RecordedTest so_far() const;
    std::uint64_t lines_taken() const { return taken_; }
    /// Whether the stream has ended.
    bool over() const { return over_; }
    /// Age (s) of each record processed since the last call, from its arrival to now; records from
    /// the log of an earlier run are not included.
    std::vector<double> ages();
    /// Problems found in the stream, one line for each kind, and the report of quality control.
    std::string report() const;

private:
    void take_line(Lines::Line line);
    void take(StreamRecord record);
    void take_of_sensor(StreamRecord record);
    void pass_gate(StreamRecord record, SensorRecords& sensor);
    void take_of_machine(const StreamRecord& record);
    void accept(const StreamRecord& record);
    void wait_for_its_time(StreamRecord& record);
    void end(const std::string& why);
    void note_far_off(const StreamRecord& record, const char* who, double strain);
    void note(const std::string& kind, const std::string& text);
    void look_for_numbers(const StreamRecord& record);
    bool goes_by_phase(const SensorSample& sample) const;
    double own_strain(const SensorSample& sample) const;
    double strain_of(double t, const SensorSample& sample) const;
    using Timelines = std::map<unsigned, SensorTimeline>;
    Timelines timelines() const;
    RecordedTest test_of(const Timelines& timelines) const;
    Recording recording_of(const SensorInfo& info, const SensorTimeline& timeline) const;
    void check_clocks(RecordedTest& test, const Timelines& timelines) const;
    std::optional<double> clock_ahead(const SensorInfo& info, const SensorTimeline& timeline) const;
    std::string report_on_sensors(const Timelines& timelines) const;

    std::unique_ptr<Lines> lines_;
    RecordParser parser_;
    std::vector<SensorInfo> infos_;
    LiveSettings settings_;
    Gate gate_;
    std::map<unsigned, SensorRecords> sensors_;
    std::map<double, StreamRecord> machine_; // by axial strain
    MachineTimes times_;
    // number and first message of each kind of problem
    std::map<std::string, std::pair<std::uint64_t, std::string>> notes_;
    MachineTrack track_;
    std::vector<Instant> arrivals_;
    std::uint64_t taken_ = 0;
    double followed_ = 0, first_t_ = 0;
    Instant began_, waiting_since_;
    bool over_ = false, begun_ = false;
};

} // namespace bris
