#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/network/network_results.hpp"
#include "scenarios/network/network_simulation.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// Links that are always up, lose nothing and take no time worth mentioning.
NetworkSettings perfect(Strategy strategy) {
    NetworkSettings s;
    s.rocks = 2;
    s.rock.strategy = strategy;
    for (LinkProperties* link : {&s.rock_link, &s.cloud_link}) {
        link->loss = link->outage = link->jitter = 0;
        link->latency = 1e-3;
    }
    return s;
}

TruthSettings trains_of(double duration, double headway = 600) {
    TruthSettings t;
    t.duration = duration;
    t.headway = headway;
    t.passage = 8;
    t.delay = 20;
    t.change_time = duration / 2;
    return t;
}

void check_balance(const PacketBalance& b) { CHECK(b.made == b.delivered + b.lost() + b.queued); }

const LinkCounts& counts(const NetworkSimulation& n, std::size_t link) {
    return n.links()[link].counts;
}

} // namespace

TEST_SUITE("network/simulation") {
    TEST_CASE("every packet made is delivered, lost or queued, for every strategy and fault") {
        const Truth truth(trains_of(7200), 3);
        std::uint64_t lost_on_air = 0, lost_full = 0, queued = 0;
        for (std::uint64_t k = 0; k < 24; ++k) {
            NetworkSettings s;
            s.rocks = 3;
            s.hosts = 2;
            s.rock.strategy = static_cast<Strategy>(k % 4);
            s.rock_link.loss = 0.05 * static_cast<double>(k % 5);
            s.rock_link.repeats = static_cast<double>(k % 3);
            s.rock_link.jitter = 0.2;
            s.rock_link.outage_start = 100 + 10 * static_cast<double>(k);
            s.rock_link.outage = k % 2 == 0 ? 300 : 0;
            s.rock_link.interval = 1000;
            s.rock_link.buffer = k % 3 == 0 ? 5000 : 1 << 20;
            s.cloud_link.outage_start = 7000; // until after the end
            s.cloud_link.loss = 0.1;
            s.cloud_link.repeats = 0;
            if (k % 6 == 0) s.rock_power.battery = 5;   // empties
            if (k % 8 == 0) s.host_power.battery = 500; // empties until the sun rises
            NetworkSimulation n(s, truth, k);
            n.run();
            const PacketBalance b = n.balance();
            CAPTURE(k);
            check_balance(b);
            CHECK(b.made > 0);
            lost_on_air += b.lost_on_air;
            lost_full += b.lost_full;
            queued += b.queued;
            for (std::size_t link = 0; link < 5; ++link) { // and for each link
                const LinkCounts& c = counts(n, link);
                CHECK(c.offered ==
                      c.delivered + c.lost_on_air + c.lost_full + c.buffered + c.in_flight);
            }
        }
        CHECK(lost_on_air > 0);
        CHECK(lost_full > 0);
        CHECK(queued > 0);
    }

    TEST_CASE("the lifetime of a battery is capacity over mean power") {
        TruthSettings t = trains_of(40 * 86400, 1e7); // no train before the end
        t.headway = 1e8;
        const Truth truth(t, 1);
        for (const double on : {10.0, 20.0, 60.0}) {
            NetworkSettings s = perfect(Strategy::duty_cycled);
            s.rock.duty_on = on;
            s.rock_power.battery = 400;
            NetworkSimulation n(s, truth, 1);
            n.run();
            const double found = n.rocks()[0].empty_at, expected = duty_cycle_lifetime(s);
            CAPTURE(on);
            REQUIRE(std::isfinite(found));
            CHECK(found > 100 * s.rock.duty_period);
            CHECK(found == doctest::Approx(expected).epsilon(1e-3));
            const EnergyUse& use = n.rocks()[0].use;
            CHECK(use.total() == doctest::Approx(400).epsilon(1e-9)); // all of it, and no more
        }
    }

    TEST_CASE("nothing is lost if the buffer holds an outage, and one packet is if it is smaller") {
        const Truth truth(trains_of(3600), 1);
        NetworkSettings s = perfect(Strategy::continuous);
        s.rock_link.outage_start = 1000.1; // a packet is made at 1000.0 s and the last at 1400.0 s
        s.rock_link.outage = 400;
        s.rock_link.interval = 0;
        // a packet of 80 samples and 500 B each 0.4 s: 1000 packets in the outage
        const double bytes = s.header_bytes + s.sample_bytes * s.packet_samples,
                     packets = s.rock_link.outage * s.rock.sampling_rate / s.packet_samples;
        s.rock_link.buffer = packets * bytes;
        NetworkSimulation enough(s, truth, 1);
        enough.run();
        CHECK(enough.balance().lost() == 0);
        CHECK(counts(enough, 0).largest_buffered_bytes > 0.99 * s.rock_link.buffer);
        s.rock_link.buffer -= 2 * bytes;
        NetworkSimulation short_of(s, truth, 1);
        short_of.run();
        CHECK(short_of.balance().lost_full >= 1);
        CHECK(short_of.balance().lost_full <= 4 * s.rocks);
        check_balance(short_of.balance());
    }

    TEST_CASE(
        "rocks wake by timetable, by motion and periodically, and continuous ones always do") {
        const Truth truth(trains_of(7200), 5);
        double bytes[4], share[4];
        for (std::size_t k = 0; k < 4; ++k) {
            NetworkSettings s = perfect(static_cast<Strategy>(k));
            s.rock.session = 180;
            s.rock.lead = 90;
            NetworkSimulation n(s, truth, 1);
            n.run();
            const StrategyResult r = result_of(n, s, truth);
            bytes[k] = r.bytes_per_day;
            share[k] = r.recorded_share;
            CAPTURE(k);
            CHECK(n.balance().lost() == 0);
        }
        // 200 Hz x (6 + 20 / 80) B x 2 rocks, without the last packets
        CHECK(bytes[0] == doctest::Approx(2 * 200 * 6.25 * 86400).epsilon(2e-3));
        CHECK(bytes[1] == doctest::Approx(0.3 * bytes[0]).epsilon(0.02)); // 180 of 600 s
        CHECK(bytes[3] == doctest::Approx(bytes[0] / 30).epsilon(0.1));   // 20 of 600 s
        CHECK(share[0] > 0.999); // without the packet that is filled at the end
        CHECK(share[1] > 0.99);
        CHECK(share[2] > 0.85); // without the rest before the train came
        CHECK(bytes[2] < 0.05 * bytes[0]);
        CHECK(share[3] < 0.2);
    }

    TEST_CASE("the pre-trigger buffer keeps what came before the rock woke") {
        const Truth truth(trains_of(3600), 5);
        double share[2];
        for (int k = 0; k < 2; ++k) {
            NetworkSettings s = perfect(Strategy::triggered);
            s.rock.pre_trigger = k == 0 ? 0 : 1;
            s.rock.trigger_level = 1;
            NetworkSimulation n(s, truth, 1);
            n.run();
            share[k] = result_of(n, s, truth).recorded_share;
        }
        CHECK(share[1] - share[0] == doctest::Approx(1.0 / 10).epsilon(0.35)); // 1 of 8 + 2 s
    }

    TEST_CASE("a setting changed in mid-run takes effect at the next contact, for the rock named") {
        const Truth truth(trains_of(7200), 2);
        NetworkSettings s = perfect(Strategy::continuous);
        s.changes = {{.time = 3600,
                      .rock = 1,
                      .all = false,
                      .values = {{&InstalledRockSettings::sampling_rate, 100.0}}}};
        NetworkSimulation n(s, truth, 1);
        n.run();
        const auto& rocks = n.rocks();
        CHECK(rocks[0].samples == doctest::Approx(7200 * 200).epsilon(1e-3));
        CHECK(rocks[1].samples == doctest::Approx(3600 * 200 + 3600 * 100).epsilon(1e-3));
        REQUIRE(n.applied_changes().size() == 1);
        CHECK(n.applied_changes()[0].rock == 1);
        CHECK(n.applied_changes()[0].time > 3600);
        CHECK(n.applied_changes()[0].time < 3601);
        CHECK(n.balance().lost() == 0);

        s = perfect(Strategy::triggered); // asleep: not before its next contact
        s.contact_interval = 1000;
        s.changes = {{.time = 3100, .strategy = Strategy::continuous}};
        TruthSettings quiet = trains_of(7200);
        quiet.headway = 1e6;
        const Truth none(quiet, 2);
        NetworkSimulation later(s, none, 1);
        later.run();
        for (const AppliedChange& a : later.applied_changes()) CHECK(a.time == 4000);
        CHECK(later.applied_changes().size() == 2);
        CHECK(later.rocks()[0].samples == doctest::Approx(3200 * 200).epsilon(1e-3));
    }

    TEST_CASE("a warning comes after the change, and sooner by a strategy that listens") {
        TruthSettings t = trains_of(7200);
        const Truth truth(t, 8);
        double delay[2];
        for (const Strategy strategy : {Strategy::continuous, Strategy::duty_cycled}) {
            NetworkSettings s = perfect(strategy);
            s.rock.duty_period = 60;
            NetworkSimulation n(s, truth, 1);
            n.run();
            const StrategyResult r = result_of(n, s, truth);
            CHECK(r.false_warnings == 0);
            delay[strategy == Strategy::continuous ? 0 : 1] = r.alarm_delay;
        }
        CHECK(delay[0] > 1);
        CHECK(delay[0] < t.passage);
        CHECK_FALSE(delay[1] < delay[0]);
    }

    TEST_CASE("the same seed gives the same bits, alone and next to other simulations") {
        const Truth truth(trains_of(3600), 4);
        std::vector<std::vector<double>> traces(6); // times of arrival, and charges at the end
        run_ensemble(6, 3, [&](std::size_t k) {
            NetworkSettings s;
            s.rock.strategy = k % 2 == 0 ? Strategy::continuous : Strategy::triggered;
            NetworkSimulation n(s, truth, 9);
            n.run();
            for (const Received& r : n.received()) traces[k].push_back(r.time);
            for (const NetworkRock& rock : n.rocks()) traces[k].push_back(rock.charge);
        });
        CHECK(traces[2] == traces[0]);
        CHECK(traces[4] == traces[0]);
        CHECK(traces[3] == traces[1]);
        CHECK(traces[1] != traces[0]);
    }

    TEST_CASE("a host without sun goes dark and comes back when the sun shines") {
        TruthSettings t = trains_of(86400 * 2, 7200);
        const Truth truth(t, 4);
        NetworkSettings s = perfect(Strategy::triggered);
        s.host_power.battery = 5000; // 2.8 h of 0.5 W: empty before dawn
        NetworkSimulation n(s, truth, 1);
        n.run();
        const NetworkHost& host = n.hosts()[0];
        // peak 10 W x 12 h x 2 / pi per day
        CHECK(host.gained == doctest::Approx(2 * 10 * 43200 * 2 / pi).epsilon(1e-9));
        CHECK(host.spilled > 0);
        CHECK(5000 + host.gained - host.spilled - host.use.total() ==
              doctest::Approx(host.charge).epsilon(1e-9)); // the account closes
        CHECK(host.use.standing < 0.5 * 86400 * 2 * 0.95); // it was dark for a while
        check_balance(n.balance());
    }

    TEST_CASE("files of changes and timetables are refused with the file and the line") {
        const TemporaryDirectory folder;
        const auto refusal = [&](const std::string& text) {
            write_whole(folder / "c.csv", text);
            return message_of<InputError>([&] { (void)read_changes(folder / "c.csv", 3); });
        };
        CHECK(
            refusal("t_s,rock,strategy\n10,0,2\n20,1,\n").find("c.csv:3: expected at least one") !=
            std::string::npos);
        CHECK(refusal("t_s,rock,sampling_rate_Hz\n10,0,150\n").find("c.csv:2: sampling_rate_Hz") !=
              std::string::npos);
        CHECK(refusal("t_s,rock,strategy\n10,4,2\n").find("c.csv:2: rock: expected") !=
              std::string::npos);
        CHECK(refusal("t_s,rock,colour\n10,1,2\n").find("found column 'colour'") !=
              std::string::npos);
        CHECK(refusal("t_s,rock,strategy,lead_s\n10,1,2,30\n").empty());
        TruthSettings t = trains_of(7200);
        t.timetable = folder / "t.csv";
        write_whole(folder / "t.csv", "planned_s,arrival_s\n600,620\n900,\n905,\n");
        CHECK(message_of<InputError>([&] {
                  (void)Truth(t, 1);
              }).find("t.csv:4: expected arrivals") != std::string::npos);
        write_whole(folder / "t.csv", "planned_s,arrival_s\n600,620\n,900\n");
        CHECK(message_of<InputError>([&] {
                  (void)Truth(t, 1);
              }).find("t.csv:3: planned_s: expected a number") != std::string::npos);
        write_whole(folder / "t.csv", "planned_s,arrival_s\n600,620\n900,\n");
        const Truth truth(t, 1);
        REQUIRE(truth.trains().size() == 2);
        CHECK(truth.trains()[0].arrival == 620);
        CHECK(truth.trains()[1].arrival == 900);
    }
}
