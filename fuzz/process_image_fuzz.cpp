#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <busbar/core/numeric_range.hpp>
#include <busbar/server/process_image.hpp>

#include "image_script.hpp"
#include "require.hpp"
#include "support/source_caller.hpp"

namespace process_image_fuzz {

using namespace busbar;
using namespace busbar::server;
using fuzz::Bytes;
using fuzz::require;

namespace {

constexpr std::uint32_t max_pins = 2;
constexpr std::uint32_t max_waiting_writes = 3;
constexpr std::uint32_t max_additions = 2;

struct CallEnd final : server::detail::SourceCallOwner {
    bool done{false};
    void call_completed() override { done = true; }
};

/// Variables that came together: in the image, and as a memory of their own that is what the task's
/// should be.
struct Part {
    ImageLayout layout;
    std::unique_ptr<ImageMemory> model;
    ImageMemory* task{nullptr};
    std::uint32_t first{0};
};

/// One Write call. Of its items are known: whether it is to be done, and what it then makes of the
/// variable as it is at that time.
struct Call {
    explicit Call(std::size_t count) : data(count), ranges(count), items(count), is_good(count) {}

    std::vector<DataValue> data;
    std::vector<NumericRange> ranges;
    std::vector<WriteItem> items;
    std::vector<bool> is_good;
    std::unique_ptr<server::detail::SourceWrite> call;
    std::unique_ptr<CallEnd> end{std::make_unique<CallEnd>()};
};

/// That places do not overlap, and lie where their block ends or before.
void check_places(const ImageLayout& layout)
{
    for (const ImagePlace& place : layout.places()) {
        if (place.runtime != nullptr) {
            continue;
        }
        const std::size_t end = std::size_t{place.offset} + place.bytes();
        require(end <= (place.in_arrays ? layout.array_bytes() : layout.plain_bytes()));
        for (const ImagePlace& other : layout.places()) {
            require(&other == &place || other.runtime != nullptr ||
                    other.in_arrays != place.in_arrays || other.offset >= end ||
                    other.offset + other.bytes() <= place.offset);
        }
    }
}

/// A process image with its task and its server's side, and what all of it should be.
class World {
public:
    explicit World(fuzz::Script& script) : script_{&script}
    {
        ImageLayout layout = layout_of(1 + script_->byte() % 5);
        image_ = ProcessImage::create(std::move(layout), {.max_pins = max_pins,
                                                          .max_queued_scans = 2,
                                                          .max_waiting_writes = max_waiting_writes,
                                                          .max_additions = max_additions});
        parts_.back().task = &image_->memory();
        source_ = std::make_unique<ImageSource>(image_);
        sources_.add(*source_);
    }

    void step()
    {
        switch (script_->byte() % 10) {
        case 0:
        case 1:
        case 2:
            scan();
            break;
        case 3:
        case 4:
        case 5:
            write();
            break;
        case 6:
            hold();
            break;
        case 7:
            follow();
            break;
        case 8:
            add();
            break;
        default:
            halt();
        }
        check_reads();
    }
    void finish()
    {
        for (const ImagePin& pin : pins_) {
            check(pin);
        }
    }

private:
    /// What the script wants and there is room for; a part of the model with it.
    [[nodiscard]] ImageLayout layout_of(int count)
    {
        ImageLayout layout;
        Part part;
        part.first = size();
        for (; count != 0; --count) {
            ImageVariable variable = fuzz::variable(*script_);
            const auto handle = part.layout.add(variable);
            require(!handle || *handle == layout.size());
            if (handle && script_->byte() % 4 == 3) {
                variable.runtime = runtime(part.layout[*handle].bytes());
            }
            require(layout.add(variable).has_value() == handle.has_value());
        }
        check_places(layout);
        Part& kept = parts_.emplace_back(std::move(part));
        kept.model = std::make_unique<ImageMemory>(kept.layout);
        for (std::uint32_t i = 0; i < layout.size(); ++i) {
            if (layout[i].runtime != nullptr) { // a runtime's texts are what they are
                const ImagePlace& place = kept.layout[i];
                std::copy_n(kept.model->bytes(place), place.bytes(), layout[i].runtime);
            }
        }
        return layout;
    }
    [[nodiscard]] std::span<std::byte> runtime(std::size_t bytes)
    {
        auto& memory = runtimes_.emplace_back((bytes + 7) / 8);
        return std::as_writable_bytes(std::span{memory}).first(bytes);
    }
    [[nodiscard]] std::uint32_t size() const
    {
        return parts_.empty()
                   ? 0
                   : parts_.back().first + static_cast<std::uint32_t>(parts_.back().layout.size());
    }
    [[nodiscard]] Part& part_of(std::uint32_t handle)
    {
        return *std::find_if(parts_.rbegin(), parts_.rend(),
                             [&](const Part& part) { return part.first <= handle; });
    }
    [[nodiscard]] Variant now(std::uint32_t handle)
    {
        const Part& part = part_of(handle);
        return part.model->load(handle - part.first);
    }

    /// What the Write makes of the variable as it is now, or nothing.
    [[nodiscard]] std::optional<Variant> written(const WriteItem& item)
    {
        const Variant& value = item.data->value;
        if (item.range == nullptr) {
            return value;
        }
        const auto handle = static_cast<std::uint32_t>(item.handle);
        const ImagePlace& place = image_->place(handle);
        if (place.is_text() && item.range->bounds().size() == place.dimensions.size() + 1) {
            return std::nullopt; // a part of a text
        }
        Variant changed = now(handle);
        return write_range(changed, *item.range, value) ? std::optional{changed} : std::nullopt;
    }
    /// Does it in the model; false if it is not to be done.
    [[nodiscard]] bool apply(const WriteItem& item, ImageMemory& memory, std::uint32_t first)
    {
        const auto value = written(item);
        return value &&
               memory.store(static_cast<std::uint32_t>(item.handle) - first, *value).is_good();
    }
    [[nodiscard]] bool is_right(const WriteItem& item)
    {
        if (item.handle >= size() ||
            image_->place(static_cast<std::uint32_t>(item.handle)).is_read_only) {
            return false;
        }
        Part& part = part_of(static_cast<std::uint32_t>(item.handle));
        ImageMemory trial{part.layout};
        for (std::uint32_t i = 0; i < part.layout.size(); ++i) {
            require(trial.store(i, part.model->load(i)).is_good());
        }
        return apply(item, trial, part.first);
    }

    void scan()
    {
        image_->begin_scan();
        for (const auto& call : waiting_) {
            for (std::size_t i = 0; i < call->items.size(); ++i) {
                if (call->is_good[i]) {
                    Part& part = part_of(static_cast<std::uint32_t>(call->items[i].handle));
                    require(apply(call->items[i], *part.model, part.first));
                }
            }
        }
        for (int i = script_->byte() % 4; i != 0 && size() != 0; --i) {
            work();
        }
        image_->publish(DateTime::from_unix_seconds(static_cast<std::int64_t>(scans_.size())));
        std::vector<Bytes> values;
        for (std::uint32_t handle = 0; handle < size(); ++handle) {
            values.push_back(fuzz::wire(now(handle)));
        }
        scans_.push_back(std::move(values));
        is_running_ = true;
        end_calls(status::Good);
    }
    /// The task gives a variable a value.
    void work()
    {
        const std::uint32_t handle = script_->byte() % size();
        Part& part = part_of(handle);
        const ImagePlace& place = part.layout[handle - part.first];
        const Variant value = fuzz::value_for(place, now(handle), place.dimensions, *script_);
        const StatusCode stored = part.task->store(handle - part.first, value);
        require(stored == part.model->store(handle - part.first, value));
    }
    void end_calls(StatusCode good)
    {
        sources_.handle_completions();
        for (const auto& call : waiting_) {
            require(call->end->done);
            for (std::size_t i = 0; i < call->items.size(); ++i) {
                const StatusCode result = call->call->result(i);
                require(call->is_good[i] ? result == good : result.is_bad());
            }
        }
        waiting_.clear();
    }

    void write()
    {
        auto call = std::make_unique<Call>(1 + script_->byte() % 3);
        for (std::size_t i = 0; i < call->items.size(); ++i) {
            fill(*call, i);
            call->is_good[i] = is_right(call->items[i]);
        }
        call->call = std::make_unique<server::detail::SourceWrite>(sources_, call->items.size());
        for (std::size_t i = 0; i < call->items.size(); ++i) {
            call->call->ask(i, 0, call->items[i]);
        }
        const bool is_over = call->call->start(*call->end, TimePoint{}, [](auto&) {});
        if (!is_running_ || waiting_.size() == max_waiting_writes) {
            const StatusCode why =
                is_running_ ? status::Bad_TooManyOperations : status::Bad_NoCommunication;
            require(is_over);
            for (std::size_t i = 0; i < call->items.size(); ++i) {
                require(call->call->result(i) == why);
            }
            return;
        }
        const bool has_work = std::ranges::find(call->is_good, true) != call->is_good.end();
        require(is_over != has_work);
        if (has_work) {
            waiting_.push_back(std::move(call));
        }
    }
    /// Mostly what the variable can take, whole or a part.
    void fill(Call& call, std::size_t i)
    {
        WriteItem& item = call.items[i];
        const std::uint8_t choice = script_->byte();
        item.handle = choice % (size() + 1);
        item.data = &call.data[i];
        if (item.handle == size()) {
            return;
        }
        const auto handle = static_cast<std::uint32_t>(item.handle);
        const ImagePlace& place = image_->place(handle);
        auto dimensions = place.dimensions;
        if (choice >= 0x80 && !dimensions.empty()) {
            const auto range = range_in(dimensions);
            call.ranges[i] = range.value_or(NumericRange{});
            item.range = range ? &call.ranges[i] : nullptr;
        }
        if (choice >= 0xf0 && !dimensions.empty()) {
            dimensions.back() = script_->byte() % 4;
        }
        call.data[i].value = fuzz::value_for(place, now(handle), dimensions, *script_);
    }
    /// A range in these dimensions or a little past them, which become its own.
    [[nodiscard]] Result<NumericRange> range_in(std::vector<std::uint32_t>& dimensions)
    {
        std::string text;
        for (std::uint32_t& dimension : dimensions) {
            const std::uint32_t first = script_->byte() % (dimension + 1);
            const std::uint32_t count = 1 + script_->byte() % dimension;
            text += (text.empty() ? "" : ",") + std::to_string(first);
            text += count > 1 ? ":" + std::to_string(first + count - 1) : "";
            dimension = count;
        }
        return NumericRange::parse(text);
    }

    /// Holds the newest scan, or lets one go that has not changed meanwhile.
    void hold()
    {
        if (pins_.size() == max_pins) {
            require(!image_->pin());
            check(pins_.front());
            pins_.pop_front();
            return;
        }
        ImagePin pin = image_->pin();
        require(static_cast<bool>(pin) == !scans_.empty());
        if (pin) {
            require(pin.scan() == scans_.size());
            check(pin);
            pins_.push_back(std::move(pin));
        }
    }
    void follow()
    {
        const std::uint8_t choice = script_->byte();
        if (choice % 4 == 0) {
            image_->follow_scans(choice < 0x80);
            last_followed_ = 0;
            return;
        }
        if (const ImagePin pin = image_->next_scan()) {
            require(pin.scan() > last_followed_);
            last_followed_ = pin.scan();
            check(pin);
        }
    }
    void add()
    {
        const std::size_t before = size();
        const bool is_full = parts_.size() == 1 + max_additions;
        ImageLayout layout = layout_of(script_->byte() % 3);
        const auto added =
            image_->add_variables(std::move(layout), [](ImageMemory&) { return StatusCode{}; });
        require(added.has_value() != is_full);
        if (added) {
            require(added->first_handle == before && image_->size() == size());
            parts_.back().task = added->memory;
        } else {
            parts_.pop_back();
        }
    }
    void halt()
    {
        image_->halt();
        is_running_ = false;
        end_calls(status::Bad_NoCommunication);
    }

    /// That all of a scan is as it was when it was published.
    void check(const ImagePin& pin) const
    {
        const auto& values = scans_.at(pin.scan() - 1);
        require(pin.time() ==
                DateTime::from_unix_seconds(static_cast<std::int64_t>(pin.scan() - 1)));
        for (std::uint32_t handle = 0; handle < values.size(); ++handle) {
            require(fuzz::wire(pin.value(handle)) == values[handle]);
        }
    }
    /// A Read of everything, and of one variable that is not there.
    void check_reads()
    {
        server::detail::SourceRead call{sources_, size() + 1};
        for (std::uint32_t handle = 0; handle <= size(); ++handle) {
            call.ask(handle, 0, {handle, nullptr});
        }
        CallEnd end;
        require(call.start(end, TimePoint{}, [](auto&) {}));
        for (std::uint32_t handle = 0; handle <= size(); ++handle) {
            check_read(handle, call.result(handle));
        }
    }
    void check_read(std::uint32_t handle, const ReadSlot& slot) const
    {
        if (scans_.empty() || pins_.size() == max_pins) {
            require(slot.status ==
                    (scans_.empty() ? status::Bad_NoCommunication : status::Bad_TooManyOperations));
        } else if (handle == size()) {
            require(slot.status == status::Bad_NodeIdUnknown);
        } else if (handle >= scans_.back().size()) {
            require(slot.status == status::Bad_WaitingForInitialData);
        } else {
            require(slot.status ==
                    (is_running_ ? status::Good : status::Uncertain_LastUsableValue));
            const Variant& value = slot.shared != nullptr ? *slot.shared : slot.value;
            require(fuzz::wire(value) == scans_.back()[handle]);
        }
    }

    fuzz::Script* script_;
    test::TestWaker waker_;
    std::deque<std::vector<std::uint64_t>> runtimes_;
    std::deque<Part> parts_;
    std::shared_ptr<ProcessImage> image_;
    std::unique_ptr<ImageSource> source_;
    server::detail::DataSources sources_{&waker_};
    std::vector<std::unique_ptr<Call>> waiting_;
    /// Of each scan all values, encoded.
    std::vector<std::vector<Bytes>> scans_;
    std::deque<ImagePin> pins_;
    std::uint64_t last_followed_{0};
    bool is_running_{false};
};

} // namespace

/// A process image of any variables, with a task that scans, clients that read and write wholes and
/// parts, scans that are held and followed, and variables that are added; against a memory that is
/// only written to.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    World world{script};
    for (int step = 0; step < 32 && !script.is_over(); ++step) {
        world.step();
    }
    world.finish();
    return 0;
}

} // namespace process_image_fuzz
