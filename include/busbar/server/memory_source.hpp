#pragma once

#include <cstdint>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/server/data_source.hpp>

namespace busbar::server {

/// Keeps the values of its variables: for values that a program computes itself, for tests, and as
/// the example of a backend.
///
/// Used on the server's thread only. `clock` must outlive it.
class BUSBAR_API MemorySource final : public DataSource {
public:
    explicit MemorySource(const WallClock& clock) : clock_{&clock} {}

    /// Adds a variable and returns its handle.
    [[nodiscard]] std::uint64_t add(Variant value);
    /// Adds a variable for AddressSpace::add_variable; its `handle` is the argument of set(). The
    /// source must have been added to a server.
    [[nodiscard]] model::BoundValue variable(Variant value);
    using DataSource::variable;
    /// Sets a variable's value, with the time of day as source timestamp unless a time is given.
    void set(std::uint64_t handle, Variant value, StatusCode status = {}, DateTime time = {});
    /// Returns the variable; valid until the next add().
    [[nodiscard]] const DataValue& get(std::uint64_t handle) const
    {
        return values_[static_cast<std::size_t>(handle)];
    }

    [[nodiscard]] DataSourceOptions options() const override;
    void read(ReadBatch batch) override;
    void write(WriteBatch batch) override;

private:
    [[nodiscard]] StatusCode write_one(const WriteItem& item, DateTime now);

    const WallClock* clock_;
    /// The handle is the index.
    std::vector<DataValue> values_;
};

} // namespace busbar::server
