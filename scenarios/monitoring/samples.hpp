#pragma once

#include "scenarios/sensors/channels.hpp"
#include "scenarios/stream/gate.hpp"

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace bris {

/// Fields of a stream that the monitoring of a track reads.
std::vector<std::string_view> monitored_fields();

/// Samples of one sensor in order of time: a row of numbers each, with only the columns that its
/// records have, 8 bytes a number: 64 bytes for a sample with six channels and a count.
class Samples {
public:
    /// Numbers of the same time are kept once: those that came first.
    void add(const GatedRecord& record);
    /// Brings the rows that were added since into order. Returns the number of rows left out
    /// because their time was there already.
    std::size_t sort();
    std::size_t size() const { return states_.size(); }
    bool empty() const { return states_.empty(); }
    double time(std::size_t row) const { return numbers_[row * stride_]; }
    /// Whether the sensor vibrates as under a train at a row; see find_activity.
    enum class State : std::uint8_t { unknown, quiet, active };
    State& state(std::size_t row) { return states_[row]; }
    State state(std::size_t row) const { return states_[row]; }
    bool has_force() const { return column_[force] >= 0; }
    bool has_rate() const { return column_[rate] >= 0; }
    /// In SI units and body axes.
    Vec3 force_at(std::size_t row, const SensorInfo& info) const {
        return channel_of(&Recording::force).value_of(info, vector(row, force));
    }
    Vec3 rate_at(std::size_t row, const SensorInfo& info) const {
        return channel_of(&Recording::rate).value_of(info, vector(row, rate));
    }
    /// Removes the rows from `begin` to before `end`, and returns them.
    Samples extract(std::size_t begin, std::size_t end);
    /// Adds the rows of another set.
    void merge(Samples other);
    /// First row at or after a time.
    std::size_t row_at(double t) const;
    Recording recording(const SensorInfo& info) const;
    std::size_t bytes() const { return size() * (8 * stride_ + 1); }

private:
    // columns: the time, then those of all channels, with the unwrapped count as sequence
    static constexpr std::size_t columns = 1 + channel_columns.size(),
                                 count = 1 + place_of(&Recording::sequence),
                                 flags = 1 + place_of(&Recording::flags),
                                 force = 1 + place_of(&Recording::force),
                                 rate = 1 + place_of(&Recording::rate);
    void widen(std::uint64_t wanted);
    void make_room();
    Vec3 vector(std::size_t row, std::size_t name) const {
        return {number(row, name), number(row, name + 1), number(row, name + 2)};
    }
    double number(std::size_t row, std::size_t name) const;

    std::uint64_t has_ = 1;                     // bits of the columns
    std::array<std::int8_t, columns> column_{}; // place in a row; -1: it has none
    std::size_t stride_ = 0;
    std::vector<double> numbers_;
    std::vector<State> states_;
    bool is_sorted_ = true;
};

} // namespace bris
