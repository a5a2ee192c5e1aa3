#include <catch2/catch.hpp>

#include "label_bench.hpp"

namespace label_sampling_test {

// Sampling in each scan (SH-082679, 8.3: high-speed sampling).

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::controller::test;

namespace {

const std::string two_words =
    "A : INT; B : INT; C : ARRAY [0..32767] OF INT; X : ARRAY [0..8192] OF "
    "BOOL; R : LREAL;";

/// The newest sample of words.
struct Words {
    explicit Words(LabelBench& bench, std::size_t count)
    {
        std::vector<std::byte> bytes(2 * count);
        scan = bench.labels->sampled(bytes, time);
        for (std::size_t i = 0; i < bytes.size(); i += 2) {
            values.push_back(std::to_integer<int>(bytes[i]) | std::to_integer<int>(bytes[i + 1])
                                                                  << 8);
        }
    }

    std::uint64_t scan{0};
    DateTime time{};
    std::vector<int> values{};
};

std::vector<std::string> elements(const std::string& name, int count)
{
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
        names.push_back(name + "[" + std::to_string(i) + "]");
    }
    return names;
}

} // namespace

TEST_CASE("what is sampled is there with each scan's values and time")
{
    LabelBench bench{program_of(two_words)};
    auto request = bench.to_sample({"B", "A"});
    CHECK(Words(bench, 2).scan == 0);
    bench.labels->start(std::move(request));
    CHECK(Words(bench, 2).scan == 0);
    bench.variable<std::int16_t>("A") = 1;
    bench.variable<std::int16_t>("B") = 2;
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Done);
    const Words first{bench, 2};
    CHECK(first.scan != 0);
    CHECK(first.time == DateTime{bench.scans});
    CHECK(first.values == std::vector{2, 1});
    bench.variable<std::int16_t>("A") = 3;
    // Not before the next scan.
    CHECK(Words(bench, 2).scan == first.scan);
    CHECK(Words(bench, 2).values == first.values);
    bench.scan();
    bench.variable<std::int16_t>("A") = 4;
    bench.scan();
    const Words newest{bench, 2};
    CHECK(newest.scan == first.scan + 2);
    CHECK(newest.time == DateTime{bench.scans});
    CHECK(newest.values == std::vector{2, 4});
    // As long as the request's bytes, or nothing.
    CHECK(Words(bench, 1).scan == 0);
    CHECK(Words(bench, 3).scan == 0);
}

TEST_CASE("another Sample takes the place of the one before, and one without places ends it")
{
    LabelBench bench{program_of(two_words)};
    CHECK(bench.sample({"A", "B"}) == LabelStatus::Done);
    const std::uint64_t before = Words(bench, 2).scan;
    CHECK(before != 0);
    auto request = bench.to_sample({"B"});
    bench.labels->start(std::move(request));
    // Until it is done there is nothing.
    CHECK(Words(bench, 2).scan == 0);
    CHECK(Words(bench, 1).scan == 0);
    bench.scan();
    CHECK(bench.answer()->status == LabelStatus::Done);
    CHECK(Words(bench, 1).scan > before);
    CHECK(bench.sample({}) == LabelStatus::Done);
    bench.scan();
    CHECK(Words(bench, 1).scan == 0);
    CHECK(Words(bench, 0).scan == 0);
}

TEST_CASE("the points of a Sample are rounded up and limited (1941H)")
{
    struct Row {
        std::string name;
        int count;
        std::uint32_t limit;
        LabelStatus status;
    };
    const auto row = GENERATE(values<Row>({
        {"C", 32'768, 32'768, LabelStatus::Done},
        {"C", 8'192, 8'192, LabelStatus::Done},
        {"C", 8'193, 8'193, LabelStatus::TooManyPoints},
        {"C", 8'193, 16'383, LabelStatus::TooManyPoints},
        {"C", 8'193, 16'384, LabelStatus::Done},
        {"C", 1, 8'191, LabelStatus::TooManyPoints},
        // A bit is a point.
        {"X", 8'192, 8'192, LabelStatus::Done},
        {"X", 8'193, 8'192, LabelStatus::TooManyPoints},
    }));
    LabelBench bench{program_of(two_words), {.max_sampled_points = row.limit}};
    CHECK(bench.sample(elements(row.name, row.count)) == row.status);
}

TEST_CASE("32,768 points are the limit if nothing else is said, and words count")
{
    LabelBench bench{program_of(two_words)};
    auto names = elements("C", 32'765);
    names.push_back("R");
    CHECK(bench.sample(names) == LabelStatus::TooManyPoints);
    names.erase(names.begin());
    CHECK(bench.sample(names) == LabelStatus::Done);
}

TEST_CASE("a label that cannot be sampled refuses the whole Sample (1945H)")
{
    Program program = program_of(two_words);
    program.variables[0].address = "FD0";
    LabelBench bench{std::move(program)};
    CHECK(bench.sample({"B", "A"}) == LabelStatus::UnsampledDevice);
    CHECK(Words(bench, 2).scan == 0);
    CHECK(bench.sample({"B"}) == LabelStatus::Done);
    // What is refused ends what was sampled before.
    CHECK(bench.sample({"A"}) == LabelStatus::UnsampledDevice);
    CHECK(Words(bench, 1).scan == 0);
}

TEST_CASE("a PLC that does not sample says so (1946H)")
{
    LabelBench bench{program_of(two_words), {.can_sample = false}};
    CHECK(bench.sample({"A"}) == LabelStatus::SamplingUnknown);
    CHECK(Words(bench, 1).scan == 0);
    CHECK(bench.sample({}) == LabelStatus::Done);
}

TEST_CASE("labels are not sampled from the arrival of a Write to its end")
{
    LabelBench bench{program_of("A : INT; B : INT; C : INT;"), {.access_unit = 1}};
    auto write = bench.to_write({"A", "C"}, {std::byte{9}, {}, std::byte{9}, {}});
    CHECK(bench.sample({"A", "B", "A"}) == LabelStatus::Done);
    const auto sampled_with = [&](std::int16_t value) {
        bench.variable<std::int16_t>("A") = value;
        bench.variable<std::int16_t>("B") = value;
        bench.scan();
        return Words(bench, 3).values;
    };
    CHECK(sampled_with(1) == std::vector{1, 1, 1});
    bench.labels->start(std::move(write));
    // A is written in this scan, and the Write ends in the next one.
    CHECK(sampled_with(2) == std::vector{1, 2, 1});
    CHECK(bench.book.answers.empty());
    CHECK(sampled_with(3) == std::vector{3, 3, 3});
    CHECK(bench.answer()->scans == 2);
    CHECK(sampled_with(4) == std::vector{4, 4, 4});
}

TEST_CASE("a Write that is done in one scan is sampled with it")
{
    LabelBench bench{program_of(two_words)};
    CHECK(bench.sample({"A"}) == LabelStatus::Done);
    CHECK(bench.write("A", wire(std::int16_t{5})) == LabelStatus::Done);
    CHECK(Words(bench, 1).values == std::vector{5});
}

TEST_CASE("a Write behind a Sample leaves it what the first scan has")
{
    LabelBench bench{program_of("A : INT; B : INT;"), {.access_unit = 1}};
    bench.variable<std::int16_t>("A") = 7;
    auto sample = bench.to_sample({"A"});
    auto write = bench.to_write({"B", "A"}, std::vector<std::byte>(4));
    bench.labels->start(std::move(sample));
    bench.labels->start(std::move(write));
    bench.scan();
    CHECK(Words(bench, 1).values == std::vector{7});
}

TEST_CASE("nothing is sampled without communication, or for a listener that is gone")
{
    LabelBench bench{program_of(two_words)};
    CHECK(bench.sample({"A"}) == LabelStatus::Done);
    const std::uint64_t last = Words(bench, 1).scan;
    bench.labels->fail_with(LabelStatus::NoCommunication);
    bench.scan();
    CHECK(Words(bench, 1).scan == last);
    bench.labels->fail_with(LabelStatus::Done);
    bench.scan();
    CHECK(Words(bench, 1).scan == last + 2);
    bench.labels->attach(nullptr);
    bench.scan();
    CHECK(Words(bench, 1).scan == 0);
}

} // namespace label_sampling_test
