#include <catch2/catch.hpp>

#include <atomic>
#include <cstring>
#include <thread>
#include <vector>

#include <busbar/binary/reader.hpp>
#include <busbar/core/extension_object.hpp>

#include "image_fixture.hpp"

namespace image_gather_test {

// Variables of a process image that stay in a runtime's memory.

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

namespace {

/// A text as a runtime has it.
struct Label {
    std::uint32_t size;
    char text[8];
};

struct Axis {
    std::int32_t position;
    bool is_moving; // may be any byte
    double speed;
    Label label;
};

struct Runtime {
    std::int16_t numbers[3]{1, 2, 3};
    std::uint8_t flag{0};
    std::uint8_t flags[2]{};
    Axis axes[2]{};
    double levels[4]{};
    Label name{};
    std::int32_t constant{9};
};

template <typename T>
std::span<std::byte> memory_of(T& object)
{
    return std::as_writable_bytes(std::span{&object, 1});
}

std::shared_ptr<const ImageStructure> axis()
{
    const std::vector<ImageVariable> members{{BuiltInType::Int32},
                                             {BuiltInType::Boolean},
                                             {BuiltInType::Double},
                                             {BuiltInType::String, {}, sizeof Label::text}};
    return ImageStructure::create(NodeId{1, 5}, members).value();
}

/// Some variables of a runtime, and some that lie in the image.
struct GatheredImage {
    explicit GatheredImage(Runtime& from)
    {
        ImageLayout layout;
        const auto add = [&](ImageVariable variable, std::span<std::byte> memory) {
            variable.runtime = memory;
            return layout.add(variable).value();
        };
        own = layout.add({BuiltInType::Int16}).value();
        for (std::int16_t& number : from.numbers) {
            numbers.push_back(add({BuiltInType::Int16}, memory_of(number)));
        }
        flag = add({BuiltInType::Boolean}, memory_of(from.flag));
        flags = add({BuiltInType::Boolean, {2}}, memory_of(from.flags));
        own_levels = layout.add({BuiltInType::Double, {4}}).value();
        axes = add({BuiltInType::ExtensionObject, {2}, 0, axis()}, memory_of(from.axes));
        levels = add({BuiltInType::Double, {4}}, memory_of(from.levels));
        name = add({BuiltInType::String, {}, sizeof Label::text}, memory_of(from.name));
        ImageVariable fixed{BuiltInType::Int32};
        fixed.is_read_only = true;
        constant = add(fixed, memory_of(from.constant));
        image = ProcessImage::create(std::move(layout));
    }

    std::uint32_t own, flag, flags, own_levels, axes, levels, name, constant;
    std::vector<std::uint32_t> numbers;
    std::shared_ptr<ProcessImage> image;
};

void put(Label& label, std::string_view text)
{
    label.size = static_cast<std::uint32_t>(text.size());
    std::memcpy(label.text, text.data(), text.size());
}

/// What a client sees of an axis; none if it is no whole value.
struct AxisSeen {
    explicit AxisSeen(const ExtensionObject& object)
    {
        binary::Reader reader{object.binary().span()};
        position = reader.number<std::int32_t>();
        is_moving = reader.number<std::uint8_t>();
        speed = reader.number<double>();
        const auto size = reader.number<std::int32_t>();
        is_null = size == -1;
        const auto bytes = reader.bytes(size > 0 ? static_cast<std::size_t>(size) : 0);
        label.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        is_whole = reader.ok() && reader.remaining() == 0;
    }
    std::int32_t position;
    std::uint8_t is_moving;
    double speed;
    std::string label;
    bool is_null, is_whole;
};

AxisSeen seen(const ImagePin& pin, std::uint32_t handle, std::size_t element)
{
    return AxisSeen{(*pin.value(handle).array_if<ExtensionObject>())[element]};
}

/// The bytes of one axis as a client writes it.
ExtensionObject axis_of(const AxisSeen& axis)
{
    std::vector<std::byte> body(4 + 1 + 8 + 4 + axis.label.size());
    std::byte* to = body.data();
    const auto append = [&](const void* from, std::size_t size) {
        std::memcpy(to, from, size);
        to += size;
    };
    const auto size = static_cast<std::int32_t>(axis.label.size());
    append(&axis.position, sizeof axis.position);
    append(&axis.is_moving, 1);
    append(&axis.speed, sizeof axis.speed);
    append(&size, sizeof size);
    append(axis.label.data(), axis.label.size());
    return ExtensionObject::from_binary(NodeId{1, 5}, ByteString{std::span<const std::byte>{body}});
}

} // namespace

TEST_CASE("a scan gathers what stays in a runtime's memory")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    runtime.numbers[2] = 30;
    runtime.levels[3] = 2.5;
    runtime.axes[1] = {7, true, 1.5, {}};
    put(runtime.axes[1].label, "left");
    put(runtime.name, "press");
    made.image->memory().value<std::int16_t>(made.own) = 4;
    made.image->memory().values<double>(made.own_levels)[0] = 8;
    made.image->publish(DateTime{1});

    runtime.numbers[0] = 100; // of the next scan
    const ImagePin pin = made.image->pin();
    CHECK(pin.value(made.own) == Variant{std::int16_t{4}});
    CHECK(pin.value(made.numbers[0]) == Variant{std::int16_t{1}});
    CHECK(pin.value(made.numbers[1]) == Variant{std::int16_t{2}});
    CHECK(pin.value(made.numbers[2]) == Variant{std::int16_t{30}});
    CHECK(pin.value(made.flag) == Variant{false});
    CHECK(pin.value(made.own_levels) == Variant{Array<double>{8, 0, 0, 0}});
    CHECK(pin.value(made.levels) == Variant{Array<double>{0, 0, 0, 2.5}});
    CHECK(pin.value(made.name) == Variant{"press"});
    CHECK(pin.value(made.constant) == Variant{9});
    const AxisSeen axis = seen(pin, made.axes, 1);
    CHECK(axis.is_whole);
    CHECK(axis.position == 7);
    CHECK(axis.is_moving == 1);
    CHECK(axis.label == "left");
    CHECK(std::memcmp(pin.bytes(made.levels), runtime.levels, sizeof runtime.levels) == 0);
    // The task's side is the runtime's memory itself.
    CHECK(&made.image->memory().value<std::int16_t>(made.numbers[0]) == &runtime.numbers[0]);
    CHECK(made.image->memory().load(made.numbers[0]) == Variant{std::int16_t{100}});
}

TEST_CASE("what clients write gets into the runtime's memory at a scan's edge")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    made.image->publish(DateTime{1});
    TestWaker waker;
    ImageSource source{made.image};
    server::detail::DataSources sources{&waker};
    sources.add(source);
    AxisSeen axis = seen(made.image->pin(), made.axes, 0);
    axis.position = 12;
    axis.label = "right";
    const std::vector<DataValue> values{of(std::int16_t{5}),
                                        of(true),
                                        of(Array<double>{1, 2, 3, 4}),
                                        of(String{"lathe"}),
                                        of(Array<ExtensionObject>{axis_of(axis)}),
                                        of(1)};
    const NumericRange second = NumericRange::parse("1").value();
    const std::vector<WriteItem> items{
        {made.numbers[1], nullptr, &values[0]}, {made.flag, nullptr, &values[1]},
        {made.levels, nullptr, &values[2]},     {made.name, nullptr, &values[3]},
        {made.axes, &second, &values[4]},       {made.constant, nullptr, &values[5]}};
    server::detail::SourceWrite call{sources, items.size()};
    for (std::size_t i = 0; i < items.size(); ++i) {
        call.ask(i, 0, items[i]);
    }
    CallEnd owner;
    CHECK_FALSE(call.start(owner, TimePoint{}, [](auto&) {}));
    CHECK(runtime.numbers[1] == 2);
    made.image->begin_scan();
    CHECK(runtime.numbers[1] == 5);
    CHECK(runtime.numbers[0] == 1);
    CHECK(runtime.numbers[2] == 3);
    CHECK(runtime.flag == 1);
    CHECK(runtime.levels[3] == 4);
    CHECK(std::string_view{runtime.name.text, runtime.name.size} == "lathe");
    CHECK(runtime.axes[0].position == 0);
    CHECK(runtime.axes[1].position == 12);
    CHECK(std::string_view{runtime.axes[1].label.text, 5} == "right");
    CHECK(runtime.constant == 9);
    made.image->publish(DateTime{2});
    sources.handle_completions();
    REQUIRE(owner.done);
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(call.result(i) == status::Good);
    }
    CHECK(call.result(5) == status::Bad_NotWritable);
    CHECK(made.image->pin().value(made.levels) == values[2].value);
}

TEST_CASE("what is no value in a runtime's memory hurts nobody")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    std::memset(static_cast<void*>(&runtime), 0xFE, sizeof runtime);
    runtime.axes[0].label.size = sizeof Label::text + 1;
    made.image->publish(DateTime{1});
    const ImagePin pin = made.image->pin();
    CHECK(pin.value(made.flag) == Variant{true});
    CHECK(pin.value(made.flags) == Variant{Array<bool>{true, true}});
    CHECK(pin.value(made.name) == Variant{String{}});
    for (std::size_t i = 0; i < 2; ++i) {
        const AxisSeen axis = seen(pin, made.axes, i);
        CHECK(axis.is_whole);
        CHECK(axis.is_moving == 1);
        CHECK(axis.is_null);
    }
    CHECK(made.image->memory().text(made.name) == std::nullopt);
    CHECK(made.image->memory().structure(made.axes).text(3) == std::nullopt);
    CHECK(runtime.flag == 0xFE); // the runtime's own is left alone
}

TEST_CASE("what lies between two BOOLs of a runtime stays as it is")
{
    struct {
        std::uint8_t first{2};
        std::int8_t between{-2};
        std::uint8_t second{4};
    } runtime;
    ImageLayout layout;
    const auto add = [&](BuiltInType type, std::span<std::byte> memory) {
        return layout.add({.type = type, .runtime = memory}).value();
    };
    const auto first = add(BuiltInType::Boolean, memory_of(runtime.first));
    const auto between = add(BuiltInType::SByte, memory_of(runtime.between));
    const auto second = add(BuiltInType::Boolean, memory_of(runtime.second));
    const auto image = ProcessImage::create(std::move(layout));
    image->publish(DateTime{1});
    const ImagePin pin = image->pin();
    CHECK(pin.value(first) == Variant{true});
    CHECK(pin.value(between) == Variant{std::int8_t{-2}});
    CHECK(pin.value(second) == Variant{true});
    for (const std::uint32_t handle : {first, second}) {
        CHECK(*pin.bytes(handle) == std::byte{1});
    }
}

TEST_CASE("a text may be as long as its place")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    put(runtime.name, "lathe 42");
    put(runtime.axes[1].label, "sideward");
    made.image->publish(DateTime{1});
    const ImagePin pin = made.image->pin();
    CHECK(pin.value(made.name) == Variant{"lathe 42"});
    CHECK(seen(pin, made.axes, 1).label == "sideward");
}

TEST_CASE("memory that a variable cannot lie in is refused")
{
    ImageLayout layout;
    alignas(8) std::byte bytes[64]{};
    const auto refusal = [&](ImageVariable variable, std::size_t from, std::size_t size) {
        variable.runtime = std::span{bytes}.subspan(from, size);
        const auto added = layout.add(variable);
        return added ? StatusCode{} : added.error();
    };
    CHECK(refusal({BuiltInType::Int32}, 0, 8) == status::Bad_InvalidArgument);
    CHECK(refusal({BuiltInType::Int32}, 0, 3) == status::Bad_InvalidArgument);
    CHECK(refusal({BuiltInType::Int32}, 2, 4) == status::Bad_InvalidArgument);
    CHECK(refusal({BuiltInType::Double, {2}}, 4, 16) == status::Bad_InvalidArgument);
    CHECK(refusal({BuiltInType::String, {}, 5}, 0, 9) == status::Bad_InvalidArgument);
    CHECK(refusal({BuiltInType::ExtensionObject, {}, 0, axis()}, 4, axis()->size()) ==
          status::Bad_InvalidArgument);
    CHECK(layout.size() == 0);
    CHECK(layout.bytes() == 0);
    CHECK(refusal({BuiltInType::Guid}, 4, 16) == status::Good);
    CHECK(refusal({BuiltInType::String, {}, 5}, 4, 12) == status::Good);
    CHECK(refusal({BuiltInType::Double, {2}}, 8, 16) == status::Good);
    CHECK(layout.plain_bytes() == 0);
    CHECK(layout.array_bytes() == 0);
    CHECK(layout.gathered_bytes() == 28);
    CHECK(layout.bytes() == 44);
}

TEST_CASE("a variable that is added may stay in a runtime's memory")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    made.image->publish(DateTime{1});
    ImageLayout layout;
    std::int64_t added_later = 6;
    REQUIRE(layout.add({.type = BuiltInType::Int64, .runtime = memory_of(added_later)}));
    const auto added =
        made.image->add_variables(std::move(layout), [](ImageMemory&) { return StatusCode{}; });
    REQUIRE(added);
    made.image->publish(DateTime{2});
    CHECK(made.image->pin().value(added->first_handle) == Variant{std::int64_t{6}});
}

TEST_CASE("a runtime's structures are never torn, whoever reads and writes")
{
    Runtime runtime;
    const GatheredImage made{runtime};
    made.image->publish(DateTime{0});
    std::atomic<bool> done{false};
    std::atomic<unsigned> torn{0};
    std::thread task{[&] {
        for (std::int32_t number = 1; !done; ++number) {
            made.image->begin_scan();
            // What clients write is whole.
            const Axis& written = runtime.axes[1];
            torn += written.speed != written.position ? 1U : 0U;
            for (std::int16_t& each : runtime.numbers) {
                each = static_cast<std::int16_t>(number);
            }
            Axis& axis = runtime.axes[0];
            axis.position = number;
            axis.speed = number;
            put(axis.label, std::to_string(number % 10'000'000));
            made.image->publish(DateTime{number});
        }
        made.image->halt();
    }};
    std::thread reader{[&] {
        while (!done) {
            const ImagePin pin = made.image->pin();
            const auto time = pin.time().ticks;
            const AxisSeen axis = seen(pin, made.axes, 0);
            const bool is_first = time == 0;
            torn += !axis.is_whole || axis.position != time ? 1U : 0U;
            torn += axis.speed != static_cast<double>(axis.position) ? 1U : 0U;
            torn += !is_first && axis.label != std::to_string(time % 10'000'000) ? 1U : 0U;
            const Variant number{static_cast<std::int16_t>(time)};
            for (const std::uint32_t handle : made.numbers) {
                torn += !is_first && pin.value(handle) != number ? 1U : 0U;
            }
        }
    }};
    {
        ImageSource source{made.image};
        SourceCaller caller{source};
        const NumericRange second = NumericRange::parse("1").value();
        AxisSeen axis = seen(made.image->pin(), made.axes, 1);
        for (std::int32_t round = 1; round <= 1'000; ++round) {
            axis.position = round;
            axis.speed = round;
            const DataValue value = of(Array<ExtensionObject>{axis_of(axis)});
            const auto results = caller.write({{made.axes, &second, &value}});
            torn += results != std::vector<StatusCode>{status::Good} ? 1U : 0U;
            const auto values = caller.read({{made.axes, nullptr}});
            const auto* const objects = values[0].value.array_if<ExtensionObject>();
            torn += AxisSeen{(*objects)[1]}.position != round ? 1U : 0U;
        }
    }
    done = true;
    task.join();
    reader.join();
    CHECK(torn == 0);
}

} // namespace image_gather_test
