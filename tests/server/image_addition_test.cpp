#include <catch2/catch.hpp>

#include <atomic>
#include <thread>

#include <busbar/core/extension_object.hpp>

#include "image_fixture.hpp"

namespace image_addition_test {

// Variables that are added to a process image while its task runs.

using namespace busbar;
using namespace busbar::server;
using namespace busbar::test;

namespace {

const auto nothing = [](ImageMemory&) { return StatusCode{}; };

ImageLayout layout_of(const std::vector<ImageVariable>& variables)
{
    ImageLayout layout;
    for (const ImageVariable& variable : variables) {
        REQUIRE(layout.add(variable));
    }
    return layout;
}

} // namespace

TEST_CASE_METHOD(ImageFixture,
                 "what is added comes with the next scan, and begins as it was filled")
{
    scan();
    std::int16_t& kept = image->memory().value<std::int16_t>(speed);
    const std::uint32_t before = image->size();
    const auto structure =
        ImageStructure::create(NodeId{1, 5}, std::vector<ImageVariable>{{BuiltInType::Int32}});
    const auto fill = [](ImageMemory& memory) {
        memory.value<std::int32_t>(0) = 7;
        memory.values<double>(1)[1] = 2.5;
        return StatusCode{memory.set_text(2, "new") ? status::Good : status::Bad_OutOfRange};
    };
    const auto added =
        image->add_variables(layout_of({{BuiltInType::Int32},
                                        {BuiltInType::Double, {2}},
                                        {BuiltInType::String, {}, 4},
                                        {BuiltInType::ExtensionObject, {}, 0, structure.value()}}),
                             fill);
    REQUIRE(added);
    CHECK(added->first_handle == before);
    CHECK(image->size() == before + 4);
    CHECK(image->place(before + 1).elements == 2);
    CHECK(read(before).status == status::Bad_WaitingForInitialData);
    const ImagePin old = image->pin();
    CHECK(old.bytes(before) == nullptr);

    kept = 3;
    scan();
    CHECK(read(speed).value == Variant{std::int16_t{3}});
    CHECK(read(before) == DataValue{Variant{7}, {}, at(1002)});
    CHECK(read(before + 1).value == Variant{Array<double>{0, 2.5}});
    CHECK(read(before + 2).value == Variant{"new"});
    CHECK(read(before + 3).value.type() == BuiltInType::ExtensionObject);
    CHECK(read(before + 4).status == status::Bad_NodeIdUnknown);
    CHECK(old.bytes(before) == nullptr); // a pinned scan stays as it was
    added->memory->value<std::int32_t>(0) = 8;
    scan();
    CHECK(read(before).value == Variant{8});
}

TEST_CASE_METHOD(ImageFixture, "what was added is written with the others at one edge")
{
    scan();
    const auto added = image->add_variables(
        layout_of({{BuiltInType::Int32}, {BuiltInType::String, {2}, 4}}), nothing);
    REQUIRE(added);
    const DataValue five = of(std::int16_t{5});
    const DataValue six = of(6);
    const auto pending = write({{speed, nullptr, &five}, {added->first_handle, nullptr, &six}});
    image->begin_scan();
    CHECK(image->memory().value<std::int16_t>(speed) == 5);
    CHECK(added->memory->value<std::int32_t>(0) == 6);
    image->publish(at(9));
    sources->handle_completions();
    CHECK(pending.result(1) == status::Good);
    CHECK(read(added->first_handle).value == Variant{6});
    const auto range = NumericRange::parse("1").value();
    const DataValue text = of(Array<String>{"x"});
    CHECK(write_now({added->first_handle + 1, &range, &text}) == status::Good);
    CHECK(added->memory->text(1, 1) == "x");
    const DataValue wrong = of(Array<String>{"x", "12345"});
    CHECK(write_now({added->first_handle + 1, nullptr, &wrong}) == status::Bad_OutOfRange);
}

TEST_CASE("additions have limits, and one that is refused leaves nothing")
{
    ImageOptions options;
    options.max_additions = 2;
    ImageFixture f{options};
    f.scan();
    const std::uint32_t before = f.image->size();
    const auto refused = [](ImageMemory&) { return StatusCode{status::Bad_InvalidArgument}; };
    CHECK(f.image->add_variables(layout_of({{BuiltInType::Int16}}), refused).error() ==
          status::Bad_InvalidArgument);
    CHECK(f.image->add_variables(layout_of({{BuiltInType::Byte, {2U << 20U}}}), nothing).error() ==
          status::Bad_OutOfRange);
    CHECK(f.image->add_variables(layout_of({{BuiltInType::Byte, {(256U << 20U) - 16}}}), nothing)
              .error() == status::Bad_OutOfMemory);
    CHECK(f.image->size() == before);
    for (std::uint32_t i = 0; i < 2; ++i) {
        const auto added = f.image->add_variables(layout_of({{BuiltInType::Int16}}), nothing);
        REQUIRE(added);
        CHECK(added->first_handle == before + i);
    }
    CHECK(f.image->add_variables(layout_of({{BuiltInType::Int16}}), nothing).error() ==
          status::Bad_TooManyOperations);
    f.scan();
    CHECK(f.read(before + 1).value == Variant{std::int16_t{0}});
}

TEST_CASE("readers see old and new variables of one scan while they are added")
{
    ImageFixture f;
    std::atomic<bool> done{false};
    std::atomic<unsigned> torn{0};
    std::atomic<std::uint32_t> seen{0};
    f.image->publish(DateTime{0});
    const std::uint32_t first = f.image->size();
    std::vector<std::atomic<ImageMemory*>> memories(64);
    std::thread task{[&] {
        for (std::int32_t number = 1; !done; ++number) {
            f.image->begin_scan();
            f.image->memory().value<std::int16_t>(f.speed) = static_cast<std::int16_t>(number);
            for (const auto& memory : memories) {
                if (ImageMemory* const added = memory.load(std::memory_order_acquire)) {
                    added->value<std::int16_t>(0) = static_cast<std::int16_t>(number);
                }
            }
            f.image->publish(DateTime{number});
        }
    }};
    std::thread reader{[&] {
        while (!done) {
            const ImagePin pin = f.image->pin();
            const auto number = Variant{static_cast<std::int16_t>(pin.time().ticks)};
            const std::uint32_t size = f.image->size();
            std::uint32_t current = 0;
            for (std::uint32_t handle = first; handle < size; ++handle) {
                ReadSlot slot;
                pin.read(handle, slot);
                // The task has not heard of it yet, or it is of this scan.
                const bool is_new = slot.value == Variant{std::int16_t{-1}};
                torn += slot.status.is_good() && !is_new && slot.value != number ? 1U : 0U;
                current += slot.status.is_good() && slot.value == number ? 1U : 0U;
            }
            torn += pin.value(f.speed) != number ? 1U : 0U;
            seen = std::max(seen.load(), current);
        }
    }};
    for (std::size_t i = 0; i < memories.size(); ++i) {
        const auto added =
            f.image->add_variables(layout_of({{BuiltInType::Int16}}), [](ImageMemory& memory) {
                memory.value<std::int16_t>(0) = -1;
                return StatusCode{};
            });
        REQUIRE(added);
        memories[i].store(added->memory, std::memory_order_release);
    }
    while (seen < memories.size()) {
        std::this_thread::yield();
    }
    done = true;
    task.join();
    reader.join();
    CHECK(torn == 0);
}

} // namespace image_addition_test
