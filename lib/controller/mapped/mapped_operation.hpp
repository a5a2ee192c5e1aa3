#pragma once

#include <cstdint>
#include <memory>

#include "mapped_table.hpp"

namespace busbar::controller::detail {

/// The objects that all operations work with.
struct MappedContext {
    MappedTable& table;
    const MappedOptions& options;
    /// May be null.
    MappedObserver* observer;
    /// May be null.
    const model::SpaceReader* space;
};

/// Carries out a client's request: sends requests to the PLC, one after the other, and processes
/// the answers.
class MappedOperation {
public:
    MappedOperation() = default;
    MappedOperation(const MappedOperation&) = delete;
    MappedOperation& operator=(const MappedOperation&) = delete;
    virtual ~MappedOperation() = default;

    /// Returns the next request to the PLC; null once the client is answered. The labels must be
    /// resolved.
    [[nodiscard]] virtual std::unique_ptr<backend::LabelRequest> next(MappedContext& context) = 0;
    /// Processes the answer to the last request; next() continues after it.
    virtual void done(MappedContext& context, const backend::LabelRequest& request) = 0;
    /// Prepares to begin again, because the labels had changed and nothing was done.
    virtual void restart(MappedContext&) {}
    /// Answers the whole request with `status`, which is bad.
    virtual void fail(MappedContext& context, StatusCode status) = 0;

    /// Remembers the last request and the update of labels that it is based on.
    void note(const backend::LabelRequest& request, std::uint64_t by_generation)
    {
        generation = by_generation;
        places_ = request.places.size();
        bytes_ = request.bytes.size();
    }
    /// Tells whether an answer has the size of the last request.
    [[nodiscard]] bool fits(const backend::LabelRequest& answer) const
    {
        return answer.places.size() == places_ && answer.bytes.size() == bytes_;
    }

    /// The next request waits for a turn: others are served first, however fast the PLC answers.
    bool waits_a_turn{false};
    /// If the PLC accepts no more requests, the operation waits until one is answered.
    bool waits_for_room{false};
    /// Number of restarts.
    unsigned repetitions{0};
    std::uint64_t generation{0};

private:
    std::size_t places_{0};
    std::size_t bytes_{0};
};

/// Tells whether a request may have so many labels and words (2.1).
[[nodiscard]] bool is_within(const MappedLimits& limits, std::size_t labels, std::size_t words);

/// Decodes the values in `bytes` into the slots and the Variables' kept values: all of them, or
/// none and false if a label has a value that its Variable cannot have. `offset_of(item, variable)`
/// is where the bytes of an item begin. `time` is the time of the values.
class ValueReader {
public:
    ValueReader(MappedContext& context, const std::byte* bytes, DateTime time)
        : context_{context}, bytes_{bytes}, time_{time}
    {
    }
    /// Decodes the slot's value; false if it is out of range. An unsupported Variable has no bytes.
    [[nodiscard]] bool read(MappedTable::Variable& variable, std::size_t offset,
                            server::ReadSlot& slot) const;
    /// Keeps the values of the whole batch as the last ones of their Variables.
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
