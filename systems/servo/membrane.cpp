#include "systems/servo/membrane.hpp"

#include <algorithm>

namespace bris {

void Membrane::save(Archive& archive) const {
    const std::array<double, 6> numbers{active ? 1.0 : 0.0, target_pressure,   gain,
                                        largest_step,       contact_stiffness, ring_height};
    archive.put("membrane/settings", std::span<const double>(numbers));
    archive.put("membrane/pressure", std::span<const double>(pressure));
    archive.put("membrane/radius", std::span<const double>(radius));
}

void Membrane::load(const Archive& archive) {
    const auto numbers = archive.get<double>("membrane/settings");
    active = numbers.at(0) != 0;
    target_pressure = numbers.at(1);
    gain = numbers.at(2);
    largest_step = numbers.at(3);
    contact_stiffness = numbers.at(4);
    ring_height = numbers.at(5);
    pressure = archive.get<double>("membrane/pressure");
    radius = archive.get<double>("membrane/radius");
}

double exposed_width(double own, double before, double after, double angle) {
    return (before + after - 2 * own * std::cos(angle)) / std::sin(angle);
}

double exposed_height(const Membrane& membrane, std::size_t ring, double top) {
    return std::clamp(top - static_cast<double>(ring) * membrane.ring_height, 0.0, membrane.ring_height);
}

void steer_membrane(Rows<Facets, const HostRow> facets, Rows<Planes, const PlanePlace> planes,
                    Rows<Bodies, const Position, const Force, DriveVelocity> bodies, Membrane& membrane,
                    const Platen& platen, const NearIndex<FacetPairs>& index, const Clock& clock, Health& health) {
    const Row* host = facets.column<HostRow>() + membrane.first_facet;
    const Vec3* position = bodies.column<Position>();
    const Vec3* force = bodies.column<Force>();
    Vec3* drive = bodies.column<DriveVelocity>();
    const std::size_t sectors = membrane.sectors, elements = membrane.rings * sectors;
    for (std::size_t e = 0; e < elements; ++e)
        membrane.radius[e] = position[host[e]].dot(membrane.outward[e % sectors]);
    const double top = planes.column<PlanePlace>()[platen.plane].point.z();
    const double angle = 2 * pi / static_cast<double>(sectors);
    const std::size_t group = membrane.per_element ? 1 : sectors;
    for (std::size_t g = 0; g < elements / group; ++g) {
        double push = 0, area = 0, stiffness = 0;
        for (std::size_t e = g * group; e < (g + 1) * group; ++e) {
            const std::size_t ring = e / sectors * sectors, sector = e % sectors;
            push += force[host[e]].dot(membrane.outward[sector]);
            const double width =
                exposed_width(membrane.radius[e], membrane.radius[ring + (sector + sectors - 1) % sectors],
                              membrane.radius[ring + (sector + 1) % sectors], angle);
            if (!(width > 0) && !health.bad) {
                health.bad = true;
                health.what = "membrane element " + std::to_string(e) + " is hidden by its neighbours: exposed width " +
                              std::to_string(width) + " m; try the servo per ring";
            }
            area += exposed_height(membrane, e / sectors, top) * width;
            for (Row k = index.incident_first[host[e]]; k < index.incident_first[host[e] + 1]; ++k)
                if (index.touches(index.incident[k])) stiffness += membrane.contact_stiffness;
        }
        membrane.pressure[g] = area > 0 ? push / area : 0; // no area: the platen has passed the ring
        const double error = push - membrane.target_pressure * area;
        // with no contact there is no stiffness to divide by: one contact's is the floor
        const double wanted = membrane.gain * error / std::max(stiffness, membrane.contact_stiffness);
        const double step = std::clamp(wanted, -membrane.largest_step, membrane.largest_step);
        const double speed = membrane.active ? step / clock.dt : 0;
        for (std::size_t e = g * group; e < (g + 1) * group; ++e)
            drive[host[e]] = speed * membrane.outward[e % sectors];
    }
}

} // namespace bris
