#pragma once

#include <cstdint>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/server/data_source.hpp>

namespace busbar::server {

/// Variables whose values this object holds: for values that a program computes itself, for tests,
/// and as the example of a backend.
///
/// Used on the server's thread only. `clock` must outlive it.
class BUSBAR_API MemorySource final : public DataSource {
public:
    explicit MemorySource(const WallClock& clock) : clock_{&clock} {}

    /// Adds a variable and gives its handle.
    [[nodiscard]] std::uint64_t add(Variant value);
    /// The same for AddressSpace::add_variable; its `handle` is what set() wants. The source must
    /// have been added to a server.
    [[nodiscard]] model::BoundValue variable(Variant value);
    using DataSource::variable;
    /// Gives a variable its value, with the time of day as source timestamp.
    void set(std::uint64_t handle, Variant value, StatusCode status = {});
    /// The variable; valid until the next add().
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
