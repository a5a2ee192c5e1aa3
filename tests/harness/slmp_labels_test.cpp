#include <busbar/backend/slmp_labels.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/core/status_codes.hpp>
#include <busbar/harness/log_book.hpp>
#include <busbar/harness/slmp_responder.hpp>

namespace slmp_labels_test {

// Labels of a simulated PLC by name, in virtual time and without a network.

using namespace busbar;
using namespace busbar::backend;
using namespace std::chrono_literals;

namespace {

class Listener final : public LabelListener {
public:
    void done(std::unique_ptr<LabelRequest> request) override
    {
        answers.push_back(std::move(request));
    }
    void labels_changed() override { ++changes; }

    std::vector<std::unique_ptr<LabelRequest>> answers;
    int changes{0};
};

class Clock final : public WallClock {
public:
    [[nodiscard]] DateTime now() const override { return DateTime{1}; }
};

template <std::size_t Size>
std::array<std::byte, Size> bytes(const std::array<int, Size>& values)
{
    std::array<std::byte, Size> all;
    std::ranges::transform(values, all.begin(), [](int each) { return std::byte(each); });
    return all;
}

TimePoint the_time{};

struct Plant {
    explicit Plant(std::size_t max_labels = 32)
        : labels{{.device = {.name = "line"}, .max_labels = max_labels},
                 clock,
                 [] { return the_time; },
                 log}
    {
        plc.add_label("Speed", 4, bytes<2>({0x11, 0}), 2);
        plc.add_label("Count", 5, bytes<4>({1, 2, 3, 4}), 4);
        plc.add_label("Line[2].Running", 1, bytes<1>({1}), 1);
        plc.add_label("Recipe", 9, bytes<10>({'o', 'a', 'k', 0, 0, 0, 0, 0, 0, 0}), 10);
        labels.attach(&listener);
        connect();
    }
    void connect()
    {
        Device& device = labels.device();
        the_time = std::max(the_time, device.next_deadline());
        REQUIRE(device.wants_connection(the_time));
        device.connecting(the_time);
        device.connected(the_time);
        move();
        REQUIRE(device.state() == DeviceState::Online);
    }
    void move()
    {
        Device& device = labels.device();
        for (bool is_moving = true; is_moving;) {
            is_moving = false;
            while (!device.output().empty()) {
                const auto out = device.output();
                const std::vector<std::byte> sent{out.begin(), out.end()};
                device.consume(sent.size());
                plc.feed(sent, the_time);
                is_moving = true;
            }
            while (!plc.output().empty()) {
                const auto out = plc.output();
                const std::vector<std::byte> sent{out.begin(), out.end()};
                plc.consume(sent.size());
                static_cast<void>(device.feed(sent, the_time));
                is_moving = true;
            }
        }
    }
    std::unique_ptr<LabelRequest> ask(std::unique_ptr<LabelRequest> request)
    {
        labels.start(std::move(request));
        move();
        REQUIRE(listener.answers.size() == 1);
        auto answer = std::move(listener.answers.back());
        listener.answers.clear();
        return answer;
    }
    std::unique_ptr<LabelRequest> resolve(std::vector<std::string> names)
    {
        auto request = std::make_unique<LabelRequest>();
        request->kind = LabelRequest::Kind::Resolve;
        request->names = std::move(names);
        return ask(std::move(request));
    }
    /// A request for all of these labels, whose values follow one another.
    static std::unique_ptr<LabelRequest> of(LabelRequest::Kind kind,
                                            const std::vector<ResolvedLabel>& all)
    {
        auto request = std::make_unique<LabelRequest>();
        request->kind = kind;
        for (const ResolvedLabel& label : all) {
            const auto size = static_cast<std::uint32_t>(size_of(label.kind));
            const auto offset = static_cast<std::uint32_t>(request->bytes.size());
            request->places.push_back({label.address, offset, size});
            request->bytes.resize(offset + size);
        }
        return request;
    }

    harness::LogBook log;
    Clock clock;
    harness::SlmpResponder plc;
    Listener listener;
    SlmpLabels labels;
};

} // namespace

TEST_CASE(
    "labels of a PLC have their types, and a name that it does not have costs the others none")
{
    Plant plant;
    CHECK(plant.listener.changes == 1);
    const auto answer = plant.resolve({"Speed", "Nothing", "Line[2].Running", "Recipe", "Count"});
    CHECK(answer->status == LabelStatus::Done);
    REQUIRE(answer->labels.size() == 5);
    CHECK(answer->labels[0].kind.type == LabelType::Word);
    CHECK(answer->labels[1].error == LabelError::Unknown);
    CHECK(answer->labels[2].kind.type == LabelType::Bit);
    CHECK(answer->labels[3].kind == LabelKind{LabelType::String, TimerPart::None, 8});
    CHECK(answer->labels[4].kind.type == LabelType::DoubleWord);
    CHECK(answer->labels[4].error == LabelError::None);
}

TEST_CASE("labels are read and written, in few messages")
{
    Plant plant;
    const auto known = plant.resolve({"Speed", "Line[2].Running", "Recipe", "Count"});
    auto answer = plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels));
    CHECK(answer->status == LabelStatus::Done);
    CHECK(answer->scans == 1);
    REQUIRE(answer->bytes.size() == 2 + 1 + 9 + 4);
    CHECK(answer->bytes[0] == std::byte{0x11});
    CHECK(answer->bytes[2] == std::byte{1});
    CHECK(std::memcmp(&answer->bytes[3], "oak\0\0\0\0\0", 9) == 0);
    CHECK(answer->bytes[12] == std::byte{1});

    auto write = Plant::of(LabelRequest::Kind::Write, known->labels);
    write->bytes[0] = std::byte{0x22};
    std::memcpy(&write->bytes[3], "birch", 5);
    answer = plant.ask(std::move(write));
    CHECK(answer->status == LabelStatus::Done);
    CHECK(plant.plc.label("Speed")[0] == std::byte{0x22});
    CHECK(plant.plc.label("Line[2].Running")[0] == std::byte{0});
    CHECK(std::memcmp(plant.plc.label("Recipe").data(), "birch", 6) == 0);
}

TEST_CASE("many labels take several messages, of which a write sends one at a time")
{
    Plant plant{2};
    const auto known = plant.resolve({"Speed", "Line[2].Running", "Recipe", "Count"});
    CHECK(known->scans == 2);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels))->scans == 2);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Write, known->labels))->scans == 2);
}

TEST_CASE("labels of a connection that was lost have to be resolved again")
{
    Plant plant;
    const auto known = plant.resolve({"Speed"});
    plant.labels.start(Plant::of(LabelRequest::Kind::Read, known->labels));
    plant.labels.device().lost("the cable is out", the_time);
    REQUIRE(plant.listener.answers.size() == 1);
    CHECK(plant.listener.answers[0]->status == LabelStatus::NoCommunication);
    plant.listener.answers.clear();
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels))->status ==
          LabelStatus::NoCommunication);
    plant.plc.reconnect();
    plant.connect();
    CHECK(plant.listener.changes == 2);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels))->status ==
          LabelStatus::Mismatch);
    const auto again = plant.resolve({"Speed"});
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, again->labels))->status ==
          LabelStatus::Done);
}

TEST_CASE("a label that has another type by now is a mismatch, and sampling is not known")
{
    Plant plant;
    const auto known = plant.resolve({"Speed"});
    plant.plc.clear_labels();
    plant.plc.add_label("Speed", 6, bytes<4>({0, 0, 0, 0}), 4);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels))->status ==
          LabelStatus::Mismatch);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Write, known->labels))->status ==
          LabelStatus::Mismatch);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Sample, known->labels))->status ==
          LabelStatus::SamplingUnknown);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Sample, {}))->status == LabelStatus::Done);
}

TEST_CASE("places that are not of the PLC or not of the bytes are refused")
{
    Plant plant;
    const auto known = plant.resolve({"Speed"});
    auto request = Plant::of(LabelRequest::Kind::Read, known->labels);
    request->places[0].offset = 0xFFFFFFFF;
    CHECK(plant.ask(std::move(request))->status == LabelStatus::Mismatch);
    request = Plant::of(LabelRequest::Kind::Read, known->labels);
    request->places[0].address += 7;
    CHECK(plant.ask(std::move(request))->status == LabelStatus::Mismatch);
}

TEST_CASE("an owner that goes leaves nothing behind, and the next one is served")
{
    Plant plant;
    const auto known = plant.resolve({"Speed"});
    plant.labels.start(Plant::of(LabelRequest::Kind::Read, known->labels));
    plant.labels.start(Plant::of(LabelRequest::Kind::Read, known->labels));
    plant.labels.attach(nullptr);
    plant.move();
    CHECK(plant.listener.answers.empty());
    plant.labels.attach(&plant.listener);
    CHECK(plant.ask(Plant::of(LabelRequest::Kind::Read, known->labels))->status ==
          LabelStatus::Done);
}

} // namespace slmp_labels_test
