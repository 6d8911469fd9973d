#include "systems/output/contact_frames.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/ordering.hpp"
#include "systems/output/contact_list.hpp"

#include <algorithm>

namespace bris {

namespace {

constexpr std::size_t least_chunk = 1024; // lines; the first frame often has no contact

std::vector<float> ends_of(const World& world, const std::vector<Contact>& contacts) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto position = world.column<Bodies, Position>();
    std::vector<float> ends;
    ends.reserve(6 * contacts.size());
    for (const Contact& c : contacts) {
        append_vector(ends, position[rows[c.owner]]);
        append_vector(ends, c.kind == 0 ? position[rows[c.partner]] : c.point);
    }
    return ends;
}

/// An array with a row for each contact: `add` appends the numbers of one.
template <class T, class Add>
void put(VtkhdfFile& file, const std::vector<Contact>& contacts, const char* name, const char* unit,
         unsigned components, Add&& add) {
    std::vector<T> values;
    values.reserve(components * contacts.size());
    for (const Contact& c : contacts) add(values, c);
    file.put({VtkhdfFile::On::cells, name, components, unit}, std::span<const T>(values));
}

void put_number(VtkhdfFile& file, const std::vector<Contact>& contacts, const char* name,
                const char* unit, double (*number)(const Contact&)) {
    put<float>(file, contacts, name, unit, 1, [&](std::vector<float>& to, const Contact& c) {
        to.push_back(static_cast<float>(number(c)));
    });
}

void put_vector(VtkhdfFile& file, const std::vector<Contact>& contacts, const char* name,
                const char* unit, Vec3 Contact::*vector) {
    put<float>(file, contacts, name, unit, 3,
               [&](std::vector<float>& to, const Contact& c) { append_vector(to, c.*vector); });
}

void put_label(VtkhdfFile& file, const std::vector<Contact>& contacts, const char* name,
               std::int64_t (*label)(const Contact&)) {
    put<std::int64_t>(
        file, contacts, name, "", 1,
        [&](std::vector<std::int64_t>& to, const Contact& c) { to.push_back(label(c)); });
}

} // namespace

ContactFrames::ContactFrames(const std::filesystem::path& path, const std::vector<NamedValue>& meta)
    : file_(path) {
    file_.add_meta(meta);
}

void ContactFrames::add(const World& world, const BodyFrame& frame) {
    const std::vector<Contact> contacts = contacts_of(world);
    if (!file_.has_part() || contacts.size() != file_.cells()) {
        const std::size_t usual =
            std::max({contacts.size(), 2 * frame.ids.size(), least_chunk}); // of lines
        file_.begin_part({{"contacts", CellKind::line, contacts.size(), 2 * contacts.size()}},
                         2 * usual, usual);
    }
    file_.put_points(ends_of(world, contacts));
    put_number(file_, contacts, "normal_force", "N",
               [](const Contact& c) { return c.normal_force; });
    put_number(file_, contacts, "shear_force", "N",
               [](const Contact& c) { return c.shear_force(); });
    put_number(file_, contacts, "overlap", "m", [](const Contact& c) { return c.overlap; });
    put_vector(file_, contacts, "force", "N", &Contact::force);
    put_vector(file_, contacts, "point", "m", &Contact::point);
    put_label(file_, contacts, "owner", [](const Contact& c) { return std::int64_t{c.owner}; });
    put_label(file_, contacts, "partner", [](const Contact& c) { return std::int64_t{c.partner}; });
    put_label(file_, contacts, "kind",
              [](const Contact& c) { return static_cast<std::int64_t>(c.kind); });
    file_.end_frame(frame.time);
}

} // namespace bris
