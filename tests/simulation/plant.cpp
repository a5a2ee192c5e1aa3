#include "plant.hpp"

#include <string>
#include <utility>

#include <busbar/types/ids.hpp>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

std::shared_ptr<server::ProcessImage> make_image(std::vector<std::uint32_t>& handles)
{
    server::ImageLayout layout;
    for (std::size_t i = 0; i < Plant::counters; ++i) {
        handles.push_back(layout.add({BuiltInType::Int32, {}}).value());
    }
    return server::ProcessImage::create(std::move(layout));
}

} // namespace

Plant::Plant(Scheduler& scheduler, const WallClock& clock, Chance chance)
    : scheduler_{&scheduler}, clock_{&clock}, chance_{chance}, memory_{clock},
      late_memory_{scheduler, memory_, Chance{chance.next(), 1}}, image_{make_image(scanned_)},
      image_source_{image_}, storm_image_{make_image(stormy_)}, storm_source_{storm_image_},
      times_(4 * counters), remembered_(counters),
      next_count_(counters), scan_alarm_{scheduler, [this] { scan(); }},
      memory_alarm_{scheduler, [this] { count_memory(); }},
      event_alarm_{scheduler, [this] { raise(); }}, storm_alarm_{scheduler, [this] { storm(); }}
{
}

void Plant::serve(server::Server& server)
{
    server_ = &server;
    const std::uint32_t image = server.add_source(image_source_);
    const std::uint32_t memory = server.add_source(late_memory_);
    const std::uint32_t storm = server.add_source(storm_source_);
    for (std::size_t i = 0; i < counters; ++i) {
        add_variable(Kind::Scan, i, image, scanned_[i]);
        add_variable(Kind::Memory, i, memory, memory_.add(std::int32_t{0}));
        add_variable(Kind::Storm, i, storm, stormy_[i]);
    }
    image_->publish(clock_->now());
    storm_image_->publish(clock_->now());
}

void Plant::add_variable(Kind kind, std::size_t index, std::uint32_t source, std::uint64_t handle)
{
    model::AddressSpace& space = server_->address_space();
    model::NewVariable variable;
    variable.source = source;
    variable.handle = handle;
    variable.data_type = NodeId{0, id::Int32};
    model::NewNode added;
    added.id = node(kind, index);
    added.browse_name = QualifiedName{1, String{std::to_string(added.id.numeric())}};
    added.parent = space.find(id::ObjectsFolder);
    static_cast<void>(space.add_variable(added, variable));
}

NodeId Plant::node(Kind kind, std::size_t index) const
{
    if (kind == Kind::Event) {
        return NodeId{0, id::Server};
    }
    const std::size_t first = 1'000 * (static_cast<std::size_t>(kind) + 1);
    return NodeId{1, static_cast<std::uint32_t>(first + index)};
}

std::int64_t Plant::count(Kind kind, std::size_t index) const
{
    switch (kind) {
    case Kind::Scan:
        return image_->pin().value(scanned_[index]).value_or<std::int32_t>(0);
    case Kind::Memory:
        return remembered_[index];
    case Kind::Storm:
        return storm_image_->pin().value(stormy_[index]).value_or<std::int32_t>(0);
    case Kind::Event:
        break;
    }
    return raised_;
}

TimePoint Plant::time_of(Kind kind, std::size_t index, std::int64_t number) const
{
    return times(kind, index).of(number, count(kind, index));
}

void Plant::counted(Kind kind, std::size_t index, std::int64_t number)
{
    times_[static_cast<std::size_t>(kind) * counters + index].add(number, scheduler_->now());
}

void Plant::start()
{
    scan_alarm_.set_after(1s);
    memory_alarm_.set_after(1s);
    event_alarm_.set_after(1s);
    storm_alarm_.set_after(chance_.between(1min, 10min));
}

void Plant::stop()
{
    scan_alarm_.cancel();
    memory_alarm_.cancel();
    event_alarm_.cancel();
    storm_alarm_.cancel();
    storm_ = 0;
}

void Plant::scan()
{
    image_->begin_scan();
    for (std::size_t i = 0; i < counters; ++i) {
        if (chance_.one_in(2)) {
            counted(Kind::Scan, i, ++image_->memory().value<std::int32_t>(scanned_[i]));
        }
    }
    image_->publish(clock_->now());
    if (burst_ == 0) {
        burst_ = static_cast<int>(chance_.below(40));
        scan_alarm_.set_after(chance_.between(30s, 20min));
    } else {
        --burst_;
        scan_alarm_.set_after(scan_cycle);
    }
}

void Plant::count_memory()
{
    const std::size_t index = chance_.below(counters);
    if (next_count_[index] <= scheduler_->now()) {
        next_count_[index] = scheduler_->now() + memory_pause;
        memory_.set(index, ++remembered_[index]);
        counted(Kind::Memory, index, remembered_[index]);
    }
    memory_alarm_.set_after(chance_.between(1s, 2min));
}

void Plant::raise()
{
    for (int i = chance_.pick({1, 1, 2, 15}); i > 0; --i) {
        server::Event event;
        event.message = LocalizedText{String{std::to_string(raised_ + 1)}};
        if (server_->raise_event(std::move(event))) {
            counted(Kind::Event, 0, ++raised_);
        }
    }
    event_alarm_.set_after(chance_.between(10s, 15min));
}

void Plant::storm()
{
    storm_image_->begin_scan();
    for (const std::uint32_t handle : stormy_) {
        ++storm_image_->memory().value<std::int32_t>(handle);
    }
    storm_image_->publish(clock_->now());
    if (storm_ == 0) {
        storm_ = static_cast<int>(chance_.between(2min, 6min) / storm_cycle);
        storm_alarm_.set_after(chance_.between(20min, 2h));
    } else {
        --storm_;
        storm_alarm_.set_after(storm_cycle);
    }
}

} // namespace busbar::test
