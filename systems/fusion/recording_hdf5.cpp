#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "systems/fusion/recording.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

/// Rows of N numbers, one for each sample; empty where the file has none.
template <std::size_t N> std::vector<Eigen::Matrix<double, N, 1>> rows_of(const Hdf5File& file, const std::string& dataset, std::size_t samples) {
    std::vector<Eigen::Matrix<double, N, 1>> rows;
    if (!file.has(dataset)) return rows;
    const Hdf5File::Shape shape = file.shape(dataset), wanted = N == 1 ? Hdf5File::Shape{samples} : Hdf5File::Shape{samples, N};
    require(shape == wanted, fmt::format("{}: {}: expected {} rows of {} numbers, found {} of {}", file.path().string(), dataset, samples, N, shape.front(),
                                         shape.size() > 1 ? shape[1] : 1));
    const auto numbers = file.read<double>(dataset);
    for (std::size_t k = 0; k < samples; ++k) rows.push_back(Eigen::Matrix<double, N, 1>::Map(&numbers[N * k]));
    return rows;
}

template <class Row> void write_rows(Hdf5File& file, const std::string& dataset, const std::vector<Row>& rows) {
    if (rows.empty()) return;
    constexpr auto width = static_cast<std::uint64_t>(Row::SizeAtCompileTime);
    file.write(dataset, std::span<const double>(rows.front().data(), rows.size() * width), {rows.size(), width});
}

Recording read_one(const Hdf5File& file, const SensorInfo& info) {
    const std::string group = fmt::format("/sensors/{}/", info.id), at = fmt::format("{}: {}", file.path().string(), group);
    Recording r;
    r.info = info;
    if (!file.has(group + "time")) return r; // of this one nothing was recorded
    r.time = file.read<double>(group + "time");
    const std::size_t samples = r.size();
    for (const auto& force : rows_of<3>(file, group + "accel", samples)) r.force.push_back(info.force_of(force));
    for (const auto& rate : rows_of<3>(file, group + "gyro", samples)) r.rate.push_back(info.rate_of(rate));
    for (const auto& way : rows_of<3>(file, group + "displacement", samples)) r.displacement.push_back(way);
    for (const auto& q : rows_of<4>(file, group + "quat", samples)) r.attitude.emplace_back(q[0], q[1], q[2], q[3]);
    for (const auto& strain : rows_of<1>(file, group + "strain", samples)) r.strain.push_back(strain[0]);
    if (!file.has(group + "sequence")) return r;
    r.sequence = file.read<std::uint64_t>(group + "sequence");
    require(r.sequence.size() == samples, fmt::format("{}sequence: expected {} numbers, found {}", at, samples, r.sequence.size()));
    return r;
}

} // namespace

std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path, const std::vector<SensorInfo>& sensors) {
    const Hdf5File file = Hdf5File::open(path);
    require(file.has("/sensors"), fmt::format("{}: expected a group /sensors, found none", path.string()));
    for (const std::string& name : file.names("/sensors"))
        require(std::ranges::any_of(sensors, [&](const SensorInfo& s) { return std::to_string(s.id) == name; }),
                fmt::format("{}: /sensors/{}: expected the id of a metadata file, found another", path.string(), name));
    std::vector<Recording> recordings;
    for (const SensorInfo& info : sensors) {
        const auto same = [&](const Recording& r) { return r.info.id == info.id; };
        require(std::ranges::none_of(recordings, same), fmt::format("sensor {}: expected one metadata file, found two", info.id));
        recordings.push_back(read_one(file, info));
    }
    return recordings;
}

void write_recordings_hdf5(const std::filesystem::path& path, const std::vector<Recording>& recordings) {
    Hdf5File file = Hdf5File::create(path);
    for (const Recording& r : recordings) {
        const std::string group = fmt::format("/sensors/{}/", r.info.id);
        if (r.time.empty()) continue;
        file.write(group + "time", std::span<const double>(r.time));
        std::vector<Vec3> force, rate;
        for (const Vec3& f : r.force) force.push_back(r.info.recorded_force(f));
        for (const Vec3& w : r.rate) rate.push_back(r.info.recorded_rate(w));
        std::vector<Eigen::Vector4d> attitude;
        for (const Quat& q : r.attitude) attitude.emplace_back(q.w(), q.x(), q.y(), q.z());
        write_rows(file, group + "accel", force);
        write_rows(file, group + "gyro", rate);
        write_rows(file, group + "displacement", r.displacement);
        write_rows(file, group + "quat", attitude);
        if (!r.strain.empty()) file.write(group + "strain", std::span<const double>(r.strain));
        if (!r.sequence.empty()) file.write(group + "sequence", std::span<const std::uint64_t>(r.sequence));
        file.set_attribute("/sensors/" + std::to_string(r.info.id), "accel_unit", r.info.force_unit);
        file.set_attribute("/sensors/" + std::to_string(r.info.id), "gyro_unit", r.info.rate_unit);
    }
    file.close();
}

} // namespace bris
