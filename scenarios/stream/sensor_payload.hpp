#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Samples that a SmartRock sends in one message, at equal intervals. The bytes, little-endian:
///     u8 version (1), u8 channels, u16 samples, u32 sequence, f64 time, f32 interval,
/// then for each sample one f32 for each column of its channels, in the order of the bits:
///     bit 0: ax ay az, 1: gx gy gz, 2: mx my mz, 3: strain, 4: ux uy uz, 5: qw qx qy qz, 6: temp,
///     7: batt, in the units of the sensor's metadata.
struct SensorPayload {
    static constexpr std::size_t header = 20; ///< bytes
    static constexpr std::size_t most_samples = 512;
    std::uint8_t channels = 0;
    std::uint32_t sequence = 0;      ///< of the first sample; wraps around
    double time = 0;                 ///< s, of the first sample, by the clock of the sensor
    float interval = 0;              ///< s, between samples
    std::vector<float> numbers = {}; ///< samples x columns

    /// Names of the columns of the channels, as in recordings.
    std::vector<std::string> columns() const;
    std::size_t samples() const;
};

/// Throws InputError, without a place, for anything but a whole payload: another version, a length
/// that does not match, no samples or too many, times that are not finite or too large.
SensorPayload parse_sensor_payload(std::string_view bytes);
std::string bytes_of(const SensorPayload& payload);

/// The samples as lines of a stream (RecordParser), one JSON object each. A number that is not
/// finite is left out: it was not sent.
std::vector<std::string> stream_lines(unsigned id, const SensorPayload& payload);

} // namespace bris
