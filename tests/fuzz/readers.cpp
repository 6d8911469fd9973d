#include "tests/fuzz/readers.hpp"

#include "engine/io/checkpoint.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/json_members.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/options.hpp"
#include "engine/random.hpp"
#include "scenarios/ballast_box/train.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/logger_file.hpp"
#include "scenarios/records/machine_hdf5.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/grading.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "scenarios/sensors/hdf5_recordings.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/specimens/material_card_file.hpp"
#include "scenarios/specimens/rock_material.hpp"
#include "scenarios/specimens/sensor_rocks.hpp"
#include "scenarios/stream/record_stream.hpp"
#include "scenarios/stream/sensor_payload.hpp"
#include "scenarios/stream/stream_log.hpp"
#include "systems/fields/vdb_file.hpp"
#include "tests/engine/io/encoded.hpp"
#include "tests/scenarios/records/logged.hpp"

#include <fmt/format.h>

#include <array>
#include <cstring>
#include <sstream>

namespace bris {

namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

/// The first lines of a file: short inputs are read quickly, and go wrong in the same ways.
std::string head(const fs::path& file, int lines) {
    const std::string text = read_whole(file);
    std::size_t end = 0;
    while (lines-- > 0 && end < text.size()) end = std::min(text.find('\n', end), text.size()) + 1;
    return text.substr(0, end);
}

Texts recordings(const fs::path& assets, const fs::path&) {
    return {head(assets / "smartrock/55kPa/recordings.csv", 9),
            "t,id,ax,ay,az,gx,gy,gz,flags,seq\n0,1,0,0,9.8,0,0,0,0,0\n1,1,0,-,9.8,0,0,0,1,1\n"};
}

/// Metadata of the sensors 1 and 2, which the recordings above have.
const std::vector<SensorInfo>& sensors() {
    static const std::vector<SensorInfo> both = [] {
        std::vector<SensorInfo> made(2);
        made[0].id = 1;
        made[1].id = 2;
        return made;
    }();
    return both;
}

Texts column_maps(const fs::path&, const fs::path&) {
    return {"delimiter = semicolon\ndecimal = comma\nheader_line = 3\nfirst_line = 5\n"
            "t = \"Time [ms]\", ms\nid = Nr\nax = -AccY, mg\nay = AccX, g\naz = AccZ, m/s2\n",
            "# a comment\ncomment = %\ndelimiter = tab\nt = Time, s\nid = device\n"
            "temp = T, C\ngx = wx, deg/s\ngy = wy, deg/s\ngz = wz, deg/s\n"};
}

Texts foreign_files(const fs::path&, const fs::path&) {
    return {
        "Logger; rate 200 Hz\nTime [ms];Node;Acc X [g];Acc Y [g];Acc Z [g];Gyro_X [\xb0/s];Note\n"
        "0;1;0,01;0,02;-0,99;0,1;a\n5;1;0,01;0,02;-0,99;0,1;\n",
        testing::encoded("t,id,ax,ay,az\n1,2,0,0,9.8\n2,2,0,0,9.8\n", "UTF-16LE"),
        "time,id,ax,ay,az,temp\n,,m/s2,m/s2,m/s2,C\n0.5,2,0,0,9.8,20\n1.0,2,0,0,9.8,20\n"};
}

Texts logger_files_of_all_forms(const fs::path&, const fs::path&) {
    using testing::Logged;
    Texts texts{"// Update Rate: 100.0Hz\nPacketCounter\tYear\tAcc_X\tAcc_Y\tAcc_Z\n"
                "65534\t\t0.1\t0.2\t9.8\n65535\t\t0.1\t0.2\t9.8\n0\t\t0.1\t0.2\t9.8\n",
                "1643200000000,S1:,0.01,0.03,0.99\n1643200000005,S2:,0.02,0.02,1.01\n"
                "1643200000010,S1:,0.02,0.02,1.01\n1643200000015,S2:,0.02,0.02,1.01\n"};
    for (const Logged& form :
         {Logged{',', '.', "date", "g", "deg/s", true}, Logged{';', ',', "ms", "?", "", true},
          Logged{'\t', '.', "count", "mg", "rad/s", true},
          Logged{' ', '.', "epoch ns", "?", "", true},
          Logged{';', '.', "day and time", "g", "", true}})
        texts.push_back(testing::logged_text(form, 40));
    return texts;
}

void read_logger_recordings(const fs::path& file) {
    const LoggerFile read = read_logger_file(file, {.rate = 200, .axes = "", .columns = {}});
    for (const Recording& r : read.recordings)
        if (r.size() < 2 || !(r.info.sampling_rate > 0) ||
            (!r.force.empty() && r.force.size() != r.size()))
            throw std::logic_error("a sample is incomplete");
}

Texts payloads(const fs::path&, const fs::path&) {
    SensorPayload p{.channels = 0x0f, .sequence = 7, .time = 12.5, .interval = 0.005f};
    for (int k = 0; k < 30; ++k) p.numbers.push_back(0.5f * static_cast<float>(k));
    SensorPayload all{.channels = 0xff, .sequence = 0xfffffff0u, .time = -1, .interval = 0};
    all.numbers.assign(19, 1.0f);
    return {bytes_of(p), bytes_of(all)};
}

Texts streams(const fs::path& assets, const fs::path&) {
    return {R"({"t": 1.5, "id": 3, "ax": -9.81e0, "ux": null})"
            "\n"
            R"({"axial_strain": "0.001", "deviatoric_stress_Pa": 12e3})"
            "\n# a comment\nt,id,ax,ay,az\n1,2,3,-,5\n",
            head(assets / "smartrock/55kPa/test.csv", 5)};
}

void read_stream(const fs::path& file) {
    std::istringstream lines(read_whole(file));
    RecordParser parser;
    LineSource::Line line{0, {}, {}, true};
    while (std::getline(lines, line.text)) {
        ++line.number;
        if (line.text.size() <= LineSource::longest) (void)parser.parse(line);
    }
}

void read_json(const fs::path& file) {
    const std::string text = read_whole(file);
    JsonMembers members(text);
    while (const auto member = members.next()) {
        (void)json_number(member->value);
        (void)json_text(member->value);
    }
}

struct Settings {
    double number = 1;
    unsigned count = 2;
    bool is_on = false;
    std::string text = "x";
    std::vector<double> list{1, 2};

    void declare_options(Options& option) {
        option("number", number, "m", "A number.", above(0, 10));
        option("count", count, "", "A count.", within(0, 100));
        option("is_on", is_on, "", "A switch.");
        option("text", text, "", "A text.");
        option("list", list, "Pa", "Numbers.", above(0, 1e9));
    }
    fs::path config;
};

void read_config(const fs::path& file) {
    Settings settings;
    Options options;
    settings.declare_options(options);
    options("config", settings.config, "", "File of options.");
    (void)options.parse({"--config", file.string()});
}

Texts configurations(const fs::path&, const fs::path&) {
    return {"# a comment\nnumber = 2.5\ncount = 7\nis-on = true\ntext = \"a b\" # text\n"
            "list = 1e3, 2e3,3e3\n",
            "number=0.1\nis_on=false\n"};
}

Texts stl_files(const fs::path&, const fs::path&) {
    std::string ascii = "solid rock\n";
    std::string binary(80, ' ');
    constexpr std::array<std::array<float, 3>, 4> corners{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    constexpr std::array<std::array<std::size_t, 3>, 4> faces{
        {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    const std::uint32_t count = 4;
    binary.append(reinterpret_cast<const char*>(&count), 4);
    for (const auto& face : faces) {
        ascii += "facet normal 0 0 0\nouter loop\n";
        binary.append(12, '\0');
        for (const std::size_t corner : face) {
            ascii += "vertex";
            for (const float x : corners[corner]) ascii += " " + std::to_string(x);
            ascii += "\n";
            binary.append(reinterpret_cast<const char*>(corners[corner].data()), 12);
        }
        ascii += "endloop\nendfacet\n";
        binary.append(2, '\0');
    }
    return {ascii + "endsolid rock\n", binary};
}

Texts obj_files(const fs::path&, const fs::path&) {
    return {"# a rock\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nf 1 3 2\nf 1//1 2//1 4//1\n"
            "f 1 4 3\nf -3 -2 -1\n"};
}

Texts ply_files(const fs::path&, const fs::path&) {
    const std::string head = "element vertex 4\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 4\n"
                             "property list uchar int vertex_indices\nend_header\n";
    constexpr std::array<std::array<float, 3>, 4> corners{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    constexpr std::array<std::array<int, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
    std::string text = "ply\nformat ascii 1.0\n" + head,
                binary = "ply\nformat binary_little_endian 1.0\n" + head;
    for (const auto& corner : corners) {
        for (const float x : corner) text += std::to_string(x) + " ";
        text += "\n";
        binary.append(reinterpret_cast<const char*>(corner.data()), sizeof corner);
    }
    for (const auto& face : faces) {
        text += "3";
        binary += '\3';
        for (const int index : face) text += " " + std::to_string(index);
        text += "\n";
        binary.append(reinterpret_cast<const char*>(face.data()), sizeof face);
    }
    return {text, binary};
}

Texts checkpoints(const fs::path&, const fs::path& folder) {
    Checkpoint checkpoint{"settle", 7, {{"seed", std::string("1")}}, {}};
    const std::array<double, 6> numbers{1, 2, 3, 4, 5, 6};
    checkpoint.state.put("bodies/position", std::span<const double>(numbers));
    write_checkpoint(folder / "valid.ckpt.h5", checkpoint);
    return {read_whole(folder / "valid.ckpt.h5")};
}

/// A small test with two sensors, as one file.
Texts hdf5_recordings(const fs::path&, const fs::path& folder) {
    std::vector<Recording> recordings(2);
    for (unsigned k = 0; k < 2; ++k) {
        Recording& r = recordings[k];
        r.info.id = k + 1;
        for (int i = 0; i < 8; ++i) {
            r.time.push_back(i);
            r.force.emplace_back(0, 0.1 * i, 9.81);
            r.rate.emplace_back(0.01 * i, 0, 0);
            r.strain.push_back(1e-3 * i);
        }
    }
    write_recordings_hdf5(folder / "valid.h5", recordings);
    TestCurves curves;
    std::vector<double> time;
    for (int i = 0; i < 8; ++i) {
        const auto row = curves.add_row();
        row[quantity::axial_strain] = 1e-3 * (i + 1);
        row[quantity::deviatoric_stress] = 1e4 * i;
        row[quantity::volumetric_strain] = 0;
        time.push_back(i);
    }
    write_machine_record(folder / "valid.h5", curves, time, 0.07, 55e3);
    return {read_whole(folder / "valid.h5")};
}

Texts logs(const fs::path&, const fs::path& folder) {
    using Kind = LogEntry::Kind;
    {
        StreamLog log(folder / "valid.ndjson", LoggedRecords::messages, 1 << 20);
        log.add({Kind::message, 1.7e9, "smartrock/1/imu", std::string("\0\1\xff", 3)});
        log.add({Kind::published, 1.7e9 + 1, "bris/state", "{\"q\": 1}", true, true});
        log.add({Kind::tick, 1.7e9 + 2});
    }
    StreamLog log(folder / "valid.ndjson", LoggedRecords::lines, 1 << 20);
    log.add({Kind::line, 1.7e9 + 0.1, "", R"({"t": 1, "id": 3})"});
    log.add({Kind::line, no_arrival, "", "1,2,", false});
    return {read_whole(folder / "valid.ndjson")};
}

void read_log(const fs::path& file) {
    StreamLogReader reader(file);
    while (reader.next()) {
    }
}

Texts material_cards(const fs::path&, const fs::path& folder) {
    write_material_card(folder / "card.csv",
                        {{0.7, 0.5, 0.9}, {6.3e7, 4e7, 9e7}, {0.38, 0.36, 0.4}});
    return {read_whole(folder / "card.csv")};
}

/// Two grids on a few blocks.
Texts vdb_files(const fs::path&, const fs::path& folder) {
    const Lattice lattice{Vec3(0.1, -0.2, 0.003), 0.01};
    const Box3 box{lattice.origin, lattice.origin + Vec3::Constant(0.1)};
    const VoxelBlocks blocks(lattice, std::span(&box, 1));
    VoxelField values(blocks);
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n) values[n] = Random(2, n).uniform(0, 5);
    write_vdb(folder / "valid.vdb", blocks,
              {{"fines", "kg/m3", "Fines.", {&values}, &values},
               {"saturation", "1", "Water.", {&values}, &values}},
              0, {});
    return {read_whole(folder / "valid.vdb")};
}

void read_hdf5_recordings(const fs::path& file) {
    const auto content = Hdf5Content::read(file, {"/sensors", "/bench"});
    (void)recordings_in(content, sensor_infos_in(content));
    (void)machine_record_in(content, 55e3);
}

constexpr std::array readers{
    FuzzedReader{"csv", ".csv",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {head(assets / "smartrock/55kPa/test.csv", 6),
                             "\xef\xbb\xbf# units\na,\"b, c\",d\n1,-,+2e3\r\n,5,nan\n"};
                 },
                 [](const fs::path& file) { (void)read_csv(file); }},
    FuzzedReader{"column_map", ".txt", column_maps,
                 [](const fs::path& file) { (void)read_column_map(file, recording_columns()); }},
    FuzzedReader{"recordings", ".csv", recordings,
                 [](const fs::path& file) { (void)read_recordings(file, sensors()); }},
    FuzzedReader{"guess", ".csv", foreign_files,
                 [](const fs::path& file) { (void)guess_columns(file, recording_columns()); }},
    FuzzedReader{"logger", ".csv", logger_files_of_all_forms, read_logger_recordings},
    FuzzedReader{"sensor", ".txt",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {read_whole(assets / "smartrock/rock_01.txt")};
                 },
                 [](const fs::path& file) { (void)read_sensor_info(file); }},
    FuzzedReader{"sensor_poses", ".csv",
                 [](const fs::path&, const fs::path&) -> Texts {
                     return {"x_over_radius,y_over_radius,z_over_height,qw,qx,qy,qz\n"
                             "0,0,0.25,1,0,0,0\n0.1,-0.2,0.5,0.5,0.5,0.5,0.5\n"};
                 },
                 [](const fs::path& file) { (void)read_sensor_poses(file); }},
    FuzzedReader{"json", ".json",
                 [](const fs::path&, const fs::path&) -> Texts {
                     return {R"({"a": 1, "b": -2.5e3, "c": "4", "d": null})", "{}",
                             R"({"\u0061": [1, {"b": "\"]"}], "c": NaN, "d": true})"};
                 },
                 read_json},
    FuzzedReader{"stream", ".ndjson", streams, read_stream},
    FuzzedReader{"payload", ".bin", payloads,
                 [](const fs::path& file) {
                     const SensorPayload p = parse_sensor_payload(read_whole(file));
                     if (stream_lines(1, p).size() != p.samples())
                         throw std::logic_error("a sample has no line");
                 },
                 true},
    FuzzedReader{"config", ".toml", configurations, read_config},
    FuzzedReader{"grading", ".csv",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {read_whole(assets / "gradings/arema_4.csv")};
                 },
                 [](const fs::path& file) { (void)read_grading(file); }},
    FuzzedReader{"material", ".txt",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {read_whole(assets / "materials/granite.txt")};
                 },
                 [](const fs::path& file) { (void)read_rock_material(file.string()); }},
    FuzzedReader{"material_card", ".csv", material_cards,
                 [](const fs::path& file) { (void)read_material_card(file); }},
    FuzzedReader{"train", ".csv",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {head(assets / "trains/freight.csv", 12)};
                 },
                 [](const fs::path& file) { (void)train_named(file.string()); }},
    FuzzedReader{"clump", ".csv",
                 [](const fs::path& assets, const fs::path&) -> Texts {
                     return {read_whole(assets / "clumps/rock_01.csv")};
                 },
                 [](const fs::path& file) { (void)read_clump(file); }},
    FuzzedReader{"stl", ".stl", stl_files, [](const fs::path& file) { (void)read_mesh(file); }},
    FuzzedReader{"obj", ".obj", obj_files, [](const fs::path& file) { (void)read_mesh(file); }},
    FuzzedReader{"ply", ".ply", ply_files, [](const fs::path& file) { (void)read_mesh(file); }},
    FuzzedReader{"vdb", ".vdb", vdb_files,
                 [](const fs::path& file) { (void)read_vdb(file, "fines"); }, true},
    FuzzedReader{"checkpoint", ".h5", checkpoints,
                 [](const fs::path& file) { (void)read_checkpoint(file); }},
    FuzzedReader{"hdf5", ".h5", hdf5_recordings, read_hdf5_recordings, true},
    FuzzedReader{"log", ".ndjson", logs, read_log}};

} // namespace

std::span<const FuzzedReader> fuzzed_readers() { return readers; }

} // namespace bris
