#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include <busbar/core/record.hpp>

#include "store_lists.hpp"
#include "store_records.hpp"

namespace busbar::crypto::detail {

/// Keeps rejected certificates within the limits of number and rate.
class RejectedList {
public:
    /// `records` is told which certificates are saved and discarded, which have records of their
    /// own.
    RejectedList(StoreLists& lists, StoreRecords& records, LogSink& log)
        : lists_{&lists}, records_{&records}, log_{&log}
    {
    }

    void save(const Certificate& certificate, DateTime now, std::string_view source);

private:
    [[nodiscard]] bool may_act(DateTime now, std::string_view source);
    [[nodiscard]] bool contains(const Certificate& certificate) const;
    /// Removes the oldest files until the limit has room for a new one.
    void make_room();
    void tell(RecordKind kind, const Certificate& certificate, std::string_view what) const;

    StoreLists* lists_;
    StoreRecords* records_;
    LogSink* log_;
    DateTime minute_;
    std::size_t acted_{0}; // since minute_
    /// The count of each source that has one: no more sources than the limit.
    std::map<std::string, std::size_t, std::less<>> acted_for_;
    bool is_told_{false};
};

} // namespace busbar::crypto::detail
