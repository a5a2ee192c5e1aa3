#include <busbar/backend/label.hpp>

#include <array>

namespace busbar::backend {

namespace {

struct Traits {
    /// Type of the current value of timers and counters.
    LabelType current;
    std::size_t size;
};

/// Indexed by LabelType; the sizes of texts depend on their lengths.
constexpr std::array traits{
    Traits{LabelType::Bit, 1},
    Traits{LabelType::UnsignedWord, 2},
    Traits{LabelType::UnsignedDoubleWord, 4},
    Traits{LabelType::Word, 2},
    Traits{LabelType::DoubleWord, 4},
    Traits{LabelType::Float, 4},
    Traits{LabelType::Double, 8},
    Traits{LabelType::Time, 4},
    Traits{LabelType::String, 0},
    Traits{LabelType::UnicodeString, 0},
    Traits{LabelType::UnsignedWord, 0},
    Traits{LabelType::UnsignedWord, 0},
    Traits{LabelType::UnsignedDoubleWord, 0},
    Traits{LabelType::UnsignedDoubleWord, 0},
    Traits{LabelType::UnsignedWord, 0},
    Traits{LabelType::UnsignedDoubleWord, 0},
    Traits{LabelType::Pointer, 0},
    Traits{LabelType::FunctionBlock, 0},
    Traits{LabelType::Structure, 0},
};
static_assert(traits.size() == static_cast<std::size_t>(LabelType::Structure) + 1);

const Traits& of(LabelType type)
{
    return traits[static_cast<std::size_t>(type)];
}

} // namespace

LabelType value_type(LabelType type, TimerPart part)
{
    switch (part) {
    case TimerPart::None:
        return type;
    case TimerPart::Contact:
    case TimerPart::Coil:
        return LabelType::Bit;
    case TimerPart::Current:
        break;
    }
    return of(type).current;
}

std::size_t size_of(const LabelKind& kind)
{
    const LabelType type = value_type(kind.type, kind.part);
    if (is_text(type)) {
        const std::size_t character = type == LabelType::String ? 1 : 2;
        return (std::size_t{kind.length} + 1) * character;
    }
    return of(type).size;
}

std::size_t words_of(const LabelKind& kind)
{
    return (size_of(kind) + 1) / 2;
}

} // namespace busbar::backend
