#include <catch2/catch.hpp>

#include <atomic>
#include <thread>
#include <vector>

#include <busbar/binary/reader.hpp>
#include <busbar/core/extension_object.hpp>
#include <busbar/server/process_image.hpp>

#include "support/source_caller.hpp"

namespace process_image_stress_test {

using namespace busbar;
using namespace busbar::server;

namespace {

constexpr std::uint32_t variable_count = 64;
constexpr unsigned scan_count = 20'000;
constexpr unsigned reader_count = 4;

/// All variables of a scan, whatever their type, stand for the scan's number.
struct Machine {
    explicit Machine(ImageOptions options)
    {
        ImageLayout layout;
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            static_cast<void>(layout.add({BuiltInType::Int32, {}, 0}));
        }
        text = layout.add({BuiltInType::String, {}, 16}).value();
        array = layout.add({BuiltInType::Int32, {16}, 0}).value();
        input = layout.add({BuiltInType::Int32, {8}, 0}).value();
        const std::vector<ImageVariable> members{{BuiltInType::Int32, {4}}, {BuiltInType::Int32}};
        structures = layout
                         .add({BuiltInType::ExtensionObject,
                               {2},
                               0,
                               ImageStructure::create(NodeId{1, 1}, members).value()})
                         .value();
        image = ProcessImage::create(std::move(layout), options);
    }
    void scan(std::int32_t number)
    {
        image->begin_scan();
        ImageMemory& memory = image->memory();
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            memory.value<std::int32_t>(i) = number;
        }
        memory.set_text(text, std::to_string(number));
        for (std::int32_t& element : memory.values<std::int32_t>(array)) {
            element = number;
        }
        for (std::uint32_t i = 0; i < 2; ++i) {
            const StructureView view = memory.structure(structures, i);
            for (std::int32_t& element : view.values<std::int32_t>(0)) {
                element = number;
            }
            view.value<std::int32_t>(1) = number;
        }
        image->publish(DateTime{number});
    }

    std::uint32_t text, array, input, structures;
    std::shared_ptr<ProcessImage> image;
};

/// All numbers in a body of `structures` but the array's length.
bool is_body_of(const ExtensionObject& object, std::int32_t number)
{
    binary::Reader reader{object.binary().span()};
    bool is_same = reader.number<std::int32_t>() == 4;
    for (int i = 0; i < 5; ++i) {
        is_same &= reader.number<std::int32_t>() == number;
    }
    return is_same && reader.ok() && reader.remaining() == 0;
}

/// The number that all slots agree on, or -1.
std::int32_t number_of(const Machine& machine, const ImagePin& pin)
{
    ReadSlot slot;
    const auto number = static_cast<std::int32_t>(pin.time().ticks);
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        pin.read(i, slot);
        if (slot.value.value_or<std::int32_t>(-1) != number) {
            return -1;
        }
    }
    pin.read(machine.text, slot);
    if (slot.value.get_if<String>()->view() != std::to_string(number)) {
        return -1;
    }
    pin.read(machine.array, slot);
    for (const std::int32_t element : *slot.shared->array_if<std::int32_t>()) {
        if (element != number) {
            return -1;
        }
    }
    pin.read(machine.structures, slot);
    for (const ExtensionObject& object : *slot.shared->array_if<ExtensionObject>()) {
        if (!is_body_of(object, number)) {
            return -1;
        }
    }
    return number;
}

} // namespace

TEST_CASE("no pin ever mixes two scans, and none goes back in time")
{
    ImageOptions options;
    // Fewer pins than readers: being refused is part of it.
    options.max_pins = GENERATE(1U, 2U, 8U);
    Machine machine{options};
    machine.scan(1);
    std::atomic<bool> done{false};
    std::atomic<unsigned> mixed{0};
    std::atomic<unsigned> backward{0};
    std::atomic<unsigned> reads{0};
    std::vector<std::thread> readers;
    for (unsigned r = 0; r < reader_count; ++r) {
        readers.emplace_back([&] {
            std::int32_t last = 0;
            do {
                const ImagePin pin = machine.image->pin();
                if (!pin) {
                    std::this_thread::yield();
                    continue;
                }
                const std::int32_t number = number_of(machine, pin);
                mixed += number < 0 ? 1U : 0U;
                backward += number < last ? 1U : 0U;
                last = number;
                ++reads;
            } while (!done);
        });
    }
    std::int32_t number = 1;
    while (static_cast<unsigned>(number) < scan_count || reads < 1000) {
        machine.scan(++number);
    }
    done = true;
    for (std::thread& reader : readers) {
        reader.join();
    }
    CHECK(mixed == 0);
    CHECK(backward == 0);
    CHECK(machine.image->pin().scan() == static_cast<std::uint64_t>(number));
}

TEST_CASE("a server's Reads are of one scan, its Writes of one edge, while the task runs")
{
    Machine machine{{}};
    machine.scan(1);
    std::atomic<bool> done{false};
    std::atomic<unsigned> torn{0};
    std::thread task{[&] {
        std::int32_t number = 1;
        while (!done) {
            machine.scan(++number);
            const auto input = machine.image->memory().values<std::int32_t>(machine.input);
            for (const std::int32_t element : input) {
                torn += element != input[0] ? 1U : 0U;
            }
        }
        machine.image->halt();
    }};

    ImageSource source{machine.image};
    {
        test::SourceCaller caller{source};
        std::vector<ReadItem> items;
        for (std::uint32_t i = 0; i < variable_count; ++i) {
            items.push_back({i, nullptr});
        }
        items.push_back({machine.input, nullptr});
        for (std::int32_t round = 1; round <= 500; ++round) {
            // Element by element, as one call.
            std::vector<NumericRange> ranges;
            std::vector<WriteItem> writes;
            const DataValue value{Variant{Array<std::int32_t>{round}}};
            for (int i = 0; i < 8; ++i) {
                ranges.push_back(NumericRange::parse(std::to_string(i)).value());
            }
            for (const NumericRange& range : ranges) {
                writes.push_back({machine.input, &range, &value});
            }
            const auto results = caller.write(writes);
            torn += results != std::vector<StatusCode>(8, status::Good) ? 1U : 0U;

            const auto values = caller.read(items);
            for (std::uint32_t i = 0; i < variable_count; ++i) {
                torn += values[i].value != values[0].value ? 1U : 0U;
            }
            // What was written is there as soon as the Write is answered.
            torn += values.back().value.array_if<std::int32_t>()->front() != round ? 1U : 0U;
        }
    }
    done = true;
    task.join();
    CHECK(torn == 0);
}

TEST_CASE("servers come and go while the task runs")
{
    Machine machine{{}};
    machine.scan(1);
    std::atomic<bool> done{false};
    std::thread task{[&] {
        std::int32_t number = 1;
        while (!done) {
            machine.scan(++number);
        }
    }};
    unsigned given_up = 0;
    for (std::int32_t round = 0; round < 300; ++round) {
        ImageSource source{machine.image};
        test::TestWaker waker;
        server::detail::DataSources sources{&waker};
        sources.add(source);
        const DataValue value{Variant{Array<std::int32_t>(8)}};
        struct Owner final : server::detail::SourceCallOwner {
            void call_completed() override {}
        } owner;
        server::detail::SourceWrite call{sources, 1};
        call.ask(0, 0, {machine.input, nullptr, &value});
        given_up += call.start(owner, TimePoint{}, [](auto&) {}) ? 0U : 1U;
    }
    done = true;
    task.join();
    CHECK(given_up > 0);
}

} // namespace process_image_stress_test
