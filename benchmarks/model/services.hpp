#pragma once

#include <cstdint>
#include <memory>

#include <busbar/model/address_space.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::bench {

/// A server over an address space and a client, in one thread and over a None channel in memory.
/// What is measured is the time that the server takes, with encoding and decoding.
class Services {
public:
    explicit Services(model::AddressSpace space);
    Services(const Services&) = delete;
    Services& operator=(const Services&) = delete;
    ~Services();

    [[nodiscard]] const model::AddressSpace& space() const;

    struct Cost {
        double microseconds{0};
        /// References, or targets.
        std::size_t results{0};
    };
    /// What Browse is to find, forward.
    struct Wish {
        NodeId node;
        NodeId type{0, id::HierarchicalReferences};
        bool include_subtypes{true};
        /// 0: of every NodeClass.
        std::uint32_t node_class_mask{0};
        /// References at a time; 0: all in one response.
        std::uint32_t page{0};
    };
    [[nodiscard]] Cost browse(const Wish& wish);
    /// One request for the paths from Objects to `count` variables of add_machine, spread over
    /// all `variables`.
    [[nodiscard]] Cost translate(std::uint32_t count, std::uint32_t variables);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::bench
