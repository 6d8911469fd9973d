#pragma once

#include "scenarios/ensemble/learning.hpp"
#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/ensemble/model_specimen.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/fusion/sensor_filter.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace bris {

enum class RecordingFormat : std::uint8_t { csv, hdf5 };
const std::vector<std::string>& texts_of(RecordingFormat);

/// Settings of a twin experiment: the true test, what the model has otherwise, the variants of the
/// model that are compared, and the sensors of the truth.
struct TwinSettings {
    Triaxial triaxial;
    RockParameters model{0.5, 1};
    ModelMismatch mismatch;
    std::string variants = "free,inserted,nudged,analysis";
    std::filesystem::path record;
    RecordingFormat record_format = RecordingFormat::csv;
    SensorSettings sensors;
    bool layouts = false;
    Learning learning;
    Corrections corrections;

    TwinSettings() {
        triaxial.confining_pressure = {55e3};
        triaxial.test.final_axial_strain = 0.025;
        corrections.nudging = {5e6, 100, 0.01}; // force of about the contact forces at 55 kPa
        corrections.largest_shift = 1e-6;
        learning.specimen_scatter = -1;
    }
    void declare_options(auto& option) {
        option.group("Twin experiment");
        option(
            "variants", variants, "",
            "Variants of the model that are compared, separated by commas. free: the model runs "
            "without recordings. inserted: sensor rocks are set to their recorded poses, as in the "
            "SmartRock report. nudged: springs of bounded force pull sensor rocks to their "
            "recorded poses. analysis: ensemble members learn friction and stiffness, and their "
            "forecast is corrected for all rocks by the recordings. none: only the truth runs.");
        option("model_friction", model.friction, "",
               "Friction coefficient between rocks in the model. The true one is --friction.",
               above(0, 100));
        option("model_stiffness", model.stiffness, "",
               "Contact stiffness in the model, relative to the true one.", above(0, 1e6));
        mismatch.declare_options(option);
        learning.declare_options(option);
        option("layouts", layouts, "",
               "Try other layouts of sensor rocks (how many, which ones, how often they are "
               "sampled) with the variant analysis, and write the errors that remain in rocks "
               "without sensors to layouts.csv.");
        option("record", record, "",
               "Folder into which the recordings of the truth's sensors are written, in the form "
               "that smart_triaxial reads. Empty: no recordings are written.");
        option("record_format", record_format, "", "Format of these recordings.");
        option("filter", corrections.filter.kind, "",
               "Filter that turns recordings into corrections. printed: the filter as the "
               "SmartRock report prints it. corrected: the same filter without its errors.");
        option("sensor_mode", sensors.mode, "",
               "What the sensors observe. ideal: displacement and attitude without error. "
               "tracked: displacement and attitude with noise. inertial: the tilt, which is all "
               "that an inertial sensor can observe here.");
        option("imu", sensors.imu, "",
               "Inertial sensor for --sensor-mode inertial and for --record.",
               {"lab-grade", "smartrock-like", "cheap"});
        option("interval", sensors.interval, "", "Axial strain between samples.", above(0, 1));
        option("injection_steps", corrections.injection_steps, "",
               "Number of time steps over which a correction is applied. 1: corrections are "
               "applied at once, as in the SmartRock report.",
               within(1, 1e6));
        option("largest_shift", corrections.largest_shift, "m",
               "Largest displacement of a sensor rock by direct insertion in a time step. 0: no "
               "limit.",
               within(0, 1));
        option("nudging_stiffness", corrections.nudging.stiffness, "N/m",
               "Stiffness of the critically damped springs that nudge sensor rocks.",
               above(0, 1e15));
        option("largest_nudging_force", corrections.nudging.largest_force, "N",
               "Largest force of spring and dashpot together.", within(0, 1e9));
        option("position_noise", sensors.position_noise, "m",
               "Standard deviation of tracked displacements.", above(0, 1));
        option("attitude_noise", sensors.attitude_noise, "rad",
               "Standard deviation of tracked attitudes.", above(0, 10));
        option("dropout", sensors.faults.dropout, "", "Fraction of samples that are lost.",
               within(0, 0.99));
        option("outliers", sensors.faults.outliers, "",
               "Fraction of samples that are wrong by 20 mm and half a radian.", within(0, 0.99));
        option("drift", corrections.filter.drift, "m2",
               "Variance of the model's displacement error that accumulates in a unit of axial "
               "strain.",
               within(0, 1e6));
        option("turning", corrections.filter.turning, "rad2",
               "Variance of the model's rotation error that accumulates in a unit of axial "
               "strain.",
               within(0, 1e6));
        triaxial.declare_options(option);
    }
};

} // namespace bris
