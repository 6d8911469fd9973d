#pragma once

#include "engine/simulation.hpp"
#include "scenarios/python/scene_builder.hpp"
#include "scenarios/python/written_columns.hpp"

#include <filesystem>
#include <memory>
#include <pybind11/numpy.h>
#include <stdexcept>
#include <string>
#include <utility>

namespace bris {

/// A simulation was used by a Python thread while another one runs its time steps.
struct BusyError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A simulation that Python steers. Arrays may show the memory of its columns; while one of them
/// exists, no step is taken, because a step can move the columns to other memory. `advance` lets
/// other Python threads run; until it has returned, every member throws BusyError in them.
class SteeredSimulation {
public:
    /// Takes the scene over. Throws InputError, and leaves the scene as it is, if it cannot be
    /// simulated.
    SteeredSimulation(SceneBuilder& scene, const std::string& law, unsigned threads);

    World& world() { return idle().world(); }
    /// Throws pybind11::buffer_error while arrays show columns, and InputError, before any step,
    /// if what they have written cannot be simulated. Ctrl-C ends it between two steps.
    void advance(std::uint64_t steps);
    std::uint64_t fingerprint() const;

    /// Array that shows a State column. Throws InputError if there is none of this name, or if one
    /// is to be written that WrittenColumns does not allow. `self` is the Python object of this
    /// simulation.
    pybind11::array view(const pybind11::object& self, const std::string& table,
                         const std::string& column, bool write);
    /// Copies of all State, in the order of the ids.
    pybind11::dict state() const;
    /// The touching pairs of the last step, an array for each quantity.
    pybind11::dict contacts() const;

    /// What each inertial sensor has recorded: `body`, `time` (s, on its own clock), `force` (m/s2)
    /// and `rate` (rad/s) in its axes, `saturated`. `exact`: by a device without errors.
    pybind11::list recordings(bool exact) const;

    /// Throws InputError, and writes nothing, if arrays have written what cannot be simulated.
    void save(const std::filesystem::path& path);
    /// Restores State that was saved from the same scene with the same law. Throws InputError, and
    /// changes nothing, if it is of another one.
    void load(const std::filesystem::path& path);

private:
    /// The simulation. Throws BusyError while steps are run.
    const Simulation& idle() const;
    Simulation& idle() { return const_cast<Simulation&>(std::as_const(*this).idle()); }
    void require_no_views() const;

    Simulation simulation_;
    std::string scene_; ///< names the law and, by its fingerprint, the scene at the start
    bool busy_ = false; // changed and read only by the thread that holds Python's lock
    bool several_threads_;
    std::shared_ptr<int> views_ = std::make_shared<int>(0);
    WrittenColumns written_; // since the last step
};

} // namespace bris
