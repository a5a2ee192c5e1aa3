#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <busbar/server/data_source.hpp>

/// A tank behind a field bus: its level can be read, its set point written within 0 to 100. The bus
/// answers when it has time, so the source keeps what it was asked until then.
class TankSource final : public busbar::server::DataSource {
public:
    static constexpr std::uint64_t level = 1;
    static constexpr std::uint64_t set_point = 2;

    void read(busbar::server::ReadBatch batch) override
    {
        waiting_.emplace_back(std::move(batch));
        wake();
    }
    void write(busbar::server::WriteBatch batch) override
    {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            const auto& item = batch.items()[i];
            const double* const value = item.data->value.get_if<double>();
            if (item.handle != set_point || value == nullptr) {
                batch.results()[i] = busbar::status::Bad_NotWritable;
            } else if (*value < 0 || *value > 100) {
                batch.results()[i] = busbar::status::Bad_OutOfRange;
            } else {
                set_point_ = *value;
                batch.results()[i] = busbar::status::Good;
            }
        }
        batch.complete();
    }
    void attach(busbar::server::Waker* waker) override { waker_ = waker; }
    /// The bus has its turn.
    void handle_completions() override
    {
        if (!is_bus_up_) {
            return;
        }
        for (auto& batch : std::exchange(waiting_, {})) {
            for (std::size_t i = 0; i < batch.size(); ++i) {
                const bool is_level = batch.items()[i].handle == level;
                batch.results()[i] = busbar::DataValue{is_level ? level_ : set_point_};
            }
            batch.complete();
        }
    }

    void fill_to(double percent) { level_ = percent; }
    void connect_bus(bool is_up)
    {
        is_bus_up_ = is_up;
        wake();
    }

private:
    void wake()
    {
        if (waker_ != nullptr) {
            waker_->wake();
        }
    }

    double level_{0};
    double set_point_{50};
    bool is_bus_up_{true};
    busbar::server::Waker* waker_{nullptr};
    std::vector<busbar::server::ReadBatch> waiting_;
};
