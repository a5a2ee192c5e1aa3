#pragma once

#include <catch2/catch.hpp>

#include <memory>
#include <vector>

#include <busbar/server/process_image.hpp>

#include "support/source_caller.hpp"

namespace busbar::test {

/// Knows that a call is over.
struct CallEnd final : server::detail::SourceCallOwner {
    bool done{false};
    void call_completed() override { done = true; }
};

[[nodiscard]] constexpr DateTime at(std::int64_t second)
{
    return DateTime::from_unix_seconds(second);
}

/// An image with a variable of each shape, its task played by the test, and a server's side.
class ImageFixture {
public:
    explicit ImageFixture(server::ImageOptions options = {})
    {
        server::ImageLayout layout;
        speed = layout.add({BuiltInType::Int16, {}, 0}).value();
        name = layout.add({BuiltInType::String, {}, 8}).value();
        levels = layout.add({BuiltInType::Double, {4}, 0}).value();
        grid = layout.add({BuiltInType::UInt32, {2, 3}, 0}).value();
        names = layout.add({BuiltInType::String, {3}, 8}).value();
        image = server::ProcessImage::create(std::move(layout), options);
        source = std::make_unique<server::ImageSource>(image);
        sources = std::make_unique<server::detail::DataSources>(&waker);
        sources->add(*source);
    }

    /// One scan of the task, in which `work(memory)` runs.
    template <typename Work>
    void scan(Work&& work)
    {
        image->begin_scan();
        work(image->memory());
        image->publish(at(++seconds));
    }
    void scan()
    {
        scan([](server::ImageMemory&) {});
    }
    [[nodiscard]] DataValue read(std::uint64_t handle)
    {
        server::detail::SourceRead call{*sources, 1};
        call.ask(0, 0, {handle, nullptr});
        CallEnd owner;
        REQUIRE(call.start(owner, TimePoint{}, [](auto&) {}));
        const server::ReadSlot& slot = call.result(0);
        DataValue copy{slot};
        copy.value = slot.shared != nullptr ? *slot.shared : slot.value;
        return copy;
    }
    struct Pending {
        std::unique_ptr<server::detail::SourceWrite> call;
        std::unique_ptr<CallEnd> owner;
        [[nodiscard]] StatusCode result(std::size_t index = 0) const { return call->result(index); }
    };
    [[nodiscard]] Pending write(const std::vector<server::WriteItem>& items)
    {
        Pending pending{std::make_unique<server::detail::SourceWrite>(*sources, items.size()),
                        std::make_unique<CallEnd>()};
        for (std::size_t i = 0; i < items.size(); ++i) {
            pending.call->ask(i, 0, items[i]);
        }
        pending.owner->done = pending.call->start(*pending.owner, TimePoint{}, [](auto&) {});
        return pending;
    }
    /// Writes, scans, and gives the first item's result.
    [[nodiscard]] StatusCode write_now(const server::WriteItem& item)
    {
        const Pending pending = write({item});
        scan();
        sources->handle_completions();
        REQUIRE(pending.owner->done);
        return pending.result();
    }

    std::uint32_t speed, name, levels, grid, names;
    std::int64_t seconds{1000};
    TestWaker waker;
    std::shared_ptr<server::ProcessImage> image;
    std::unique_ptr<server::ImageSource> source;
    std::unique_ptr<server::detail::DataSources> sources;
};

template <typename T>
[[nodiscard]] DataValue of(T value)
{
    return DataValue{Variant{std::move(value)}};
}

} // namespace busbar::test
