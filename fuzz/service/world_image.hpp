#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <busbar/core/clock.hpp>
#include <busbar/server/process_image.hpp>

namespace busbar::fuzz {

/// A process image with a variable of each shape. Its task is whoever calls scan().
class WorldImage {
public:
    static constexpr std::size_t variable_count = 4;

    WorldImage()
    {
        server::ImageLayout layout;
        handles_ = {layout.add({BuiltInType::Int16, {}, 0}).value(),
                    layout.add({BuiltInType::String, {}, 8}).value(),
                    layout.add({BuiltInType::Double, {4}, 0}).value(),
                    layout.add({BuiltInType::UInt32, {2, 3}, 0}).value()};
        image_ = server::ProcessImage::create(std::move(layout));
        source_ = std::make_unique<server::ImageSource>(image_);
    }

    [[nodiscard]] server::ImageSource& source() { return *source_; }
    [[nodiscard]] std::uint32_t handle(std::size_t variable) const { return handles_[variable]; }
    [[nodiscard]] Variant value(std::size_t variable) const
    {
        return image_->memory().load(handles_[variable]);
    }
    /// Takes in what was written, and gives some variables other values.
    void scan(std::int16_t number, DateTime time)
    {
        image_->begin_scan();
        server::ImageMemory& memory = image_->memory();
        memory.value<std::int16_t>(handles_[0]) = number;
        memory.set_text(handles_[1], std::to_string(number));
        memory.values<double>(handles_[2])[1] = number;
        image_->publish(time);
    }

private:
    std::array<std::uint32_t, variable_count> handles_{};
    std::shared_ptr<server::ProcessImage> image_;
    std::unique_ptr<server::ImageSource> source_;
};

} // namespace busbar::fuzz
