#pragma once

#include "engine/io/checkpoint.hpp"
#include "engine/io/run_file.hpp"
#include "engine/simulation.hpp"
#include "engine/summary.hpp"
#include "systems/output/picture.hpp"
#include "systems/output/quantities.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Bodies that carry spheres, and all facets, as a run file shows them: in the order of their ids,
/// whatever their rows. n bodies.
struct BodyFrame {
    double time = 0;               ///< s
    std::vector<std::int64_t> ids; ///< n
    std::vector<std::int64_t>
        shapes;                      ///< n, number in the clump library; empty in scenes of spheres
    std::vector<Vec3> positions;     ///< n, m
    std::vector<float> radii;        ///< n, m, bounding radius
    std::vector<float> velocities;   ///< n x 3, m/s, at the time of the positions
    std::vector<float> spins;        ///< n x 3, rad/s
    std::vector<float> orientations; ///< n x 4: w, x, y, z; empty in scenes of spheres
    std::vector<float> coordination; ///< n, bodies that touch it (boundaries count)
    std::vector<Vec3> corners;       ///< 4 per facet, m
    std::size_t quads() const { return corners.size() / 4; }
};

/// Gathers a frame from the world as the last step left it. Reads only.
BodyFrame frame_of_bodies(const World& world);

/// The bodies of a frame as a view to be drawn, sphere by sphere, as they stand in the world; `colour`
/// takes the place of a body in the frame. Facets become outlines.
View view_of_bodies(const World& world, const BodyFrame& frame,
                    const std::function<Colour(std::size_t place)>& colour);

/// Writes frames of a world to NAME.vtkhdf: id, shape, radius, velocity, spin, orientation and
/// coordination of every body, facets as quads. Throws OutputError.
class FrameWriter {
public:
    FrameWriter(const std::filesystem::path& path, const std::vector<NamedValue>& meta);
    void add(const World& world) { add(frame_of_bodies(world)); }
    void add(const BodyFrame& frame);
    std::size_t frames() const { return file_.frames(); }
    /// For tracks and whatever else belongs to the run.
    RunFile& file() { return file_; }

private:
    RunFile file_;
    std::vector<std::int64_t> ids_; // of the cells announced last
    std::vector<float> radii_;
    std::size_t quads_ = 0;
};

/// Numbers sampled during a run: a track of the run file, a CSV file, the curves of a plot. It can
/// be kept in a checkpoint beside the State of the world, under "series/NAME/".
class Series {
public:
    Series(std::string name, std::vector<RunFile::Column> columns);

    void add(std::initializer_list<double> row); ///< one number per column
    std::size_t rows() const { return values_.front().size(); }
    const std::vector<double>& column(const std::string& name) const;

    void save(Archive& archive) const;
    void load(const Archive& archive); ///< throws InputError if it is not there

    void write_csv(const std::filesystem::path& path) const;
    /// As /tracks/NAME, all rows. Once a file.
    void write_track(RunFile& file) const;

private:
    std::string name_;
    std::vector<RunFile::Column> columns_;
    std::vector<std::vector<double>> values_; // per column
};

/// Keeps a run's checkpoint: every `interval` seconds of wall time, when the user stops the run, at
/// its end, and when a guard stops it. None of it changes a bit of the run.
class CheckpointKeeper {
public:
    struct Settings {
        std::filesystem::path path; ///< NAME.ckpt.h5
        std::string scenario;
        std::vector<NamedValue> settings;
        std::function<void(Archive&)> also = {}; ///< adds what is not the world's State, as Series
        double interval = 30;                    ///< s, wall time
    };
    explicit CheckpointKeeper(Settings settings);

    /// Between blocks of steps: saves if it is time. If the user has asked to stop, saves and
    /// throws Interrupted.
    void attend(const Simulation& simulation);
    void save(const Simulation& simulation);
    /// What a guard stopped at goes beside the last good checkpoint, NAME.stopped.ckpt.h5. Returns
    /// that path.
    std::filesystem::path save_stopped(const Simulation& simulation) const;
    const std::filesystem::path& path() const { return settings_.path; }

private:
    Checkpoint checkpoint_of(const Simulation& simulation) const;
    Settings settings_;
    std::chrono::steady_clock::time_point last_;
};

/// Reads a checkpoint, of a folder of results the one written last; refuses one of another run (`may_differ` besides the settings that always
/// may), and puts its State into the simulation. Returns it, for what else was kept in it.
Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  std::initializer_list<std::string_view> may_differ = {});

/// The usual keys of a mechanical scene: energies, contacts, coordination, overlaps, unbalanced
/// ratio.
void add_quantities(Summary& summary, const Quantities& quantities);

/// Sixteen hexadecimal digits.
std::string hexadecimal(std::uint64_t fingerprint);

} // namespace bris
