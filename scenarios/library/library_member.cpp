#include "scenarios/library/library_member.hpp"

#include "engine/options.hpp"
#include "scenarios/ensemble/model_specimen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace bris {

std::vector<FavouredSpecimen> favoured(const std::vector<double>& weights, std::size_t count) {
    std::vector<FavouredSpecimen> all;
    for (std::size_t k = 0; k < weights.size(); ++k) all.push_back({k, weights[k]});
    std::ranges::stable_sort(all, std::greater{}, &FavouredSpecimen::weight);
    all.resize(std::min(count, all.size()));
    return all;
}

std::string sentence_of(const SpecimenLibrary& library,
                        const std::vector<FavouredSpecimen>& members) {
    std::string text;
    for (const FavouredSpecimen& m : members) {
        const LibrarySpecimen& s = library.specimens[m.index];
        text += fmt::format("{}{} (friction {:.2f}, porosity {:.3f}, weight {:.2f})",
                            text.empty() ? "" : ", ", s.number, s.rocks.friction, s.core_porosity,
                            m.weight);
    }
    return text;
}

Triaxial test_of(const SpecimenLibrary& library) {
    Triaxial test;
    Options options;
    test.declare_options(options);
    options.take(library.settings, "the library's settings");
    check_test(test);
    return test;
}

std::string folder_of_packing(std::uint64_t seed) { return fmt::format("packing_{}", seed); }

PreparedSpecimen make_packing(const Triaxial& described, const LibraryPacking& packing,
                              std::vector<NamedValue> settings, const Common& common,
                              const ReportProgress& report) {
    Triaxial test = described;
    test.test.porosity = packing.porosity;
    test.test.confining_pressure = test.confining_pressure.front();
    Common own = common_of_packing(common, folder_of_packing(packing.seed), packing.seed);
    own.settings = std::move(settings);
    for (NamedValue& v : own.settings) {
        if (v.key == "seed") v.value = packing.seed;
        if (v.key == "porosity") v.value = packing.porosity;
    }
    own.threads = 1;
    PreparedSpecimen made{make_scene(test, packing.seed), {}};
    made.state = make_specimen(made.scene, test.test, own, report).state;
    return made;
}

ModelRun run_member(const SpecimenLibrary& library, std::size_t index,
                    const PreparedSpecimen& packing, double pressure, double strain,
                    const ModelWatch& watch) {
    const LibrarySpecimen& s = library.specimens.at(index);
    Triaxial test = test_of(library);
    test.test.porosity = s.porosity;
    test.test.confining_pressure = pressure;
    test.test.final_axial_strain = std::min(strain, test.test.final_axial_strain);
    return run_model(packing.scene, test.test, packing.state,
                     {.name = fmt::format("specimen {}", s.number), .rocks = s.rocks}, watch);
}

double difference_from(const SpecimenLibrary& library, std::size_t index, std::size_t pressure,
                       const ModelRun& run) {
    const std::vector<float>& q = library.specimens.at(index).tests.at(pressure).q;
    const MonotonicStage stages(run.curves);
    double largest = 0, difference = 0;
    for (std::size_t k = 0; k < q.size(); ++k) {
        largest = std::max(largest, std::abs(double{q[k]}));
        const auto stage = stages.nearest(library.axis.strain(k), 1e-6);
        if (stage)
            difference =
                std::max(difference,
                         std::abs(run.curves[quantity::deviatoric_stress][*stage] - double{q[k]}));
    }
    return difference / largest;
}

} // namespace bris
