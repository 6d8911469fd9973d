// Fields of a saved state: solids, porosity, velocity and, if there are any, fines and water, as
// OpenVDB grids, as an image for ParaView and as a picture.
#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"
#include "engine/scenario.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/specimens/fouling_options.hpp"
#include "scenarios/specimens/saved_world.hpp"
#include "systems/fields/field_set.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace {

using namespace bris;

struct ExportFields {
    std::filesystem::path from = {};
    FieldSetSettings set;
    std::string fields = {};

    void declare_options(auto& option) {
        option("from", from, "",
               "Checkpoint NAME.ckpt.h5 of any scenario, or NAME.stopped.ckpt.h5 of a run that a "
               "guard has stopped.");
        option("voxel", set.voxel, "m",
               "Edge of the voxels. A scene with fouling has that of its fields.", within(1e-4, 1));
        option("samples", set.samples, "",
               "Lines across each edge of a voxel along which the rocks are measured.",
               within(2, 64));
        option("averaging", set.averaging, "m",
               "Half width of the kernel over which velocity and the measures of fouling are "
               "averaged; 0: the mean radius of the rocks.",
               within(0, 10));
        option("fields", fields, "",
               "Names of the fields to write, as density,porosity. Empty: all that the checkpoint "
               "has.");
    }
};

/// Leaves only the fields named.
void choose(FieldSet& set, const std::string& names) {
    if (names.empty()) return;
    std::vector<FieldSet::Field> chosen;
    std::string all;
    for (const FieldSet::Field& field : set.fields) all += (all.empty() ? "" : ", ") + field.name;
    for (std::size_t at = 0; at <= names.size();) {
        const std::size_t end = std::min(names.find(',', at), names.size());
        const std::string name = names.substr(at, end - at);
        const auto* field = set.find(name);
        require(field != nullptr,
                fmt::format("--fields: expected names among {}, found \"{}\"", all, name));
        require(std::ranges::find(chosen, name, &FieldSet::Field::name) == chosen.end(),
                fmt::format("--fields: expected each name once, found \"{}\" twice", name));
        chosen.push_back(*field);
        at = end + 1;
    }
    set.fields = std::move(chosen);
}

void run(const ExportFields& settings, const Common& common) {
    require(!settings.from.empty(), "--from: expected a checkpoint NAME.ckpt.h5, found none");
    const Checkpoint checkpoint = read_checkpoint(settings.from);
    World world = world_of_state(checkpoint.state);
    const auto began = this_instant();
    FieldSet set;
    Threads(common.threads).run([&] { set = fields_of(world, settings.set); });
    const double seconds = seconds_since(began);
    choose(set, settings.fields);
    const double time = world.resource<Clock>().time();
    std::vector<NamedValue> meta = common.settings;
    meta.emplace_back("run_scenario", checkpoint.scenario);
    meta.emplace_back("run_id", hexadecimal(fingerprint(checkpoint.state)));
    write_fields(set, common.out, "fields", time, meta);
    draw_slice(set, {"porosity", "velocity", "fouling", "saturation", "fouling_index"},
               common.out / "fields.png");

    Summary summary;
    summary.add("scenario_of_run", checkpoint.scenario);
    summary.add("step_of_run", checkpoint.step);
    summary.add("time_of_run_s", time);
    summary.add("voxel_m", set.blocks.lattice().size);
    summary.add("blocks", set.blocks.count());
    summary.add("averaging_used_m", set.averaging);
    summary.add("solid_volume_m3", set.solids.value);
    summary.add("solid_volume_error_m3", set.solids.error);
    if (set.void_volume > 0) {
        summary.add("void_volume_m3", set.void_volume);
        summary.add("porosity", set.void_volume / (set.void_volume + set.solids.value));
    }
    if (has_fouling_fields(world)) add_fouling_results(summary, world);
    std::string names;
    for (const FieldSet::Field& field : set.fields)
        names += (names.empty() ? "" : ",") + field.name;
    summary.add("fields_written", names);
    summary.add("fields_time_s", seconds);
    report_results(common, summary);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<ExportFields>(
        argc, argv,
        {.name = "export_fields",
         .description = "Fields of a saved state as OpenVDB grids, for ParaView and as a picture.",
         .cannot_resume = "it simulates nothing",
         .cannot_explain = "it simulates nothing"},
        run);
}
