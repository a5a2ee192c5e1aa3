#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include <busbar/server/data_source.hpp>

/// A tank on a field bus. Its level can be read, its set point written within 0 to 100. Reads
/// wait while the bus is down.
class TankSource final : public busbar::server::DataSource {
public:
    static constexpr std::uint64_t level = 0;
    static constexpr std::uint64_t set_point = 1;

    void read(busbar::server::ReadBatch batch) override
    {
        waiting_.push_back(std::move(batch));
        answer();
    }
    void write(busbar::server::WriteBatch batch) override
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const auto& item = batch.items()[i];
            const double value = item.data->value.value_or<double>(-1);
            if (item.handle != set_point) {
                batch.results()[i] = busbar::status::Bad_NotWritable;
            } else if (value < 0 || value > 100) {
                batch.results()[i] = busbar::status::Bad_OutOfRange;
            } else {
                values_[set_point] = value;
                batch.results()[i] = busbar::status::Good;
            }
        }
        batch.complete();
    }

    void fill_to(double percent) { values_[level] = percent; }
    void connect_bus(bool is_up)
    {
        is_bus_up_ = is_up;
        answer();
    }

private:
    void answer()
    {
        if (!is_bus_up_) {
            return;
        }
        for (busbar::server::ReadBatch& batch : std::exchange(waiting_, {})) {
            for (std::size_t i = 0; i < batch.size(); ++i) {
                batch.results()[i] = busbar::DataValue{values_[batch.items()[i].handle]};
            }
            batch.complete();
        }
    }

    std::array<double, 2> values_{0, 50};
    bool is_bus_up_{true};
    std::vector<busbar::server::ReadBatch> waiting_;
};
