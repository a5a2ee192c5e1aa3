#pragma once

#include <cstdint>
#include <memory>

#include "mapped_table.hpp"

namespace busbar::controller::detail {

/// What operations work with.
struct MappedContext {
    MappedTable& table;
    const MappedOptions& options;
    /// May be null.
    MappedObserver* observer;
    /// May be null.
    const model::SpaceReader* space;
};

/// What a client's request comes to: requests to the PLC, one after the other, and answers of them.
class MappedOperation {
public:
    MappedOperation() = default;
    MappedOperation(const MappedOperation&) = delete;
    MappedOperation& operator=(const MappedOperation&) = delete;
    virtual ~MappedOperation() = default;

    /// The next request to the PLC; null if the client is answered. With labels that are resolved.
    [[nodiscard]] virtual std::unique_ptr<backend::LabelRequest> next(MappedContext& context) = 0;
    /// The last one is done. next() goes on from there.
    virtual void done(MappedContext& context, const backend::LabelRequest& request) = 0;
    /// The labels were other ones, so that nothing was done: next() begins anew.
    virtual void restart(MappedContext&) {}
    /// The client is answered `status`, which is bad, for all.
    virtual void fail(MappedContext& context, StatusCode status) = 0;

    /// Remembers the last request, which goes by the labels of that update.
    void note(const backend::LabelRequest& request, std::uint64_t by_generation)
    {
        generation = by_generation;
        places_ = request.places.size();
        bytes_ = request.bytes.size();
    }
    /// Whether an answer is of the last request's size.
    [[nodiscard]] bool fits(const backend::LabelRequest& answer) const
    {
        return answer.places.size() == places_ && answer.bytes.size() == bytes_;
    }

    /// Its next request is for later: others are served before, however soon the PLC answers.
    bool waits_a_turn{false};
    /// Where the PLC takes no more requests it waits until one is answered.
    bool waits_for_room{false};
    /// How often it was restarted.
    unsigned repetitions{0};
    std::uint64_t generation{0};

private:
    std::size_t places_{0};
    std::size_t bytes_{0};
};

/// Whether a request may have so many labels and words (2.1).
[[nodiscard]] bool is_within(const MappedLimits& limits, std::size_t labels, std::size_t words);

/// Puts the values of `bytes` into the slots, and what Variables keep: all, or none and false if a
/// label has a value that its Variable cannot have. `offset_of(item, variable)` is where its bytes
/// begin. `time` is that of the values.
class ValueReader {
public:
    ValueReader(MappedContext& context, const std::byte* bytes, DateTime time)
        : context_{context}, bytes_{bytes}, time_{time}
    {
    }
    /// Fills the slot; false if it is out of range. An unsupported Variable has no bytes.
    [[nodiscard]] bool read(MappedTable::Variable& variable, std::size_t offset,
                            server::ReadSlot& slot) const;
    /// What was read of all of them is what the Variables have from now on.
    static void keep(MappedTable& table, server::ReadBatch& batch);

private:
    MappedContext& context_;
    const std::byte* bytes_;
    DateTime time_;
};

[[nodiscard]] std::unique_ptr<MappedOperation> make_read(server::ReadBatch batch);
[[nodiscard]] std::unique_ptr<MappedOperation> make_write(server::WriteBatch batch);
[[nodiscard]] std::unique_ptr<MappedOperation> make_call(server::CallBatch batch);

} // namespace busbar::controller::detail
