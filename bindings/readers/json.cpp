#include "json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace readers {

namespace {

// Linear search up to this many members; the parser sorts larger objects.
constexpr size_t few = 16;
constexpr int deepest = 64;

void append_utf8(std::string& text, uint32_t c) {
    if (c < 0x80) text += static_cast<char>(c);
    else {
        const int more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
        static const unsigned lead[] = {0, 0xc0, 0xe0, 0xf0};
        text += static_cast<char>(lead[more] | c >> 6 * more);
        for (int k = more; k-- > 0;) text += static_cast<char>(0x80 | (c >> 6 * k & 0x3f));
    }
}

// Bytes of the character at the front; 0: not UTF-8.
size_t utf8_length(std::string_view text) {
    const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[k]); };
    if (byte(0) < 0x80) return 1;
    const size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < length) return 0;
    uint32_t c = byte(0) & (0xffu >> (length + 1));
    for (size_t k = 1; k < length; ++k) {
        if ((byte(k) & 0xc0) != 0x80) return 0;
        c = c << 6 | (byte(k) & 0x3fu);
    }
    const bool too_long = (length == 3 && c < 0x800) || (length == 4 && c < 0x10000);
    return too_long || (c >= 0xd800 && c < 0xe000) || c > 0x10ffff ? 0 : length;
}

void append_quoted(std::string& out, std::string_view text) {
    out += '"';
    for (size_t i = 0; i < text.size();) {
        const char c = text[i];
        const size_t length = utf8_length(text.substr(i));
        if (length == 0) append_utf8(out, 0xfffd);
        else if (c == '"' || c == '\\') (out += '\\') += c;
        else if (c == '\n') out += "\\n";
        else if (static_cast<unsigned char>(c) < 0x20) {
            static const char digits[] = "0123456789abcdef";
            ((out += "\\u00") += digits[c >> 4]) += digits[c & 15];
        } else out += text.substr(i, length);
        i += std::max<size_t>(length, 1);
    }
    out += '"';
}

} // namespace

double Json::number() const {
    if (const uint64_t* n = whole()) return static_cast<double>(*n);
    if (const int64_t* n = std::get_if<int64_t>(&value_)) return static_cast<double>(*n);
    const double* const x = std::get_if<double>(&value_);
    return x ? *x : 0;
}

const Json::Array& Json::elements() const {
    static const Array none;
    const Array* const array = std::get_if<Array>(&value_);
    return array ? *array : none;
}

const std::vector<Json::Member>& Json::members() const {
    static const std::vector<Member> none;
    const Object* const object = std::get_if<Object>(&value_);
    return object ? object->members : none;
}

const Json* Json::find(std::string_view name) const {
    const Object* const object = std::get_if<Object>(&value_);
    if (!object) return nullptr;
    const std::vector<Member>& members = object->members;
    if (object->sorted) {
        const auto behind = std::upper_bound(members.begin(), members.end(), name,
                                             [](std::string_view n, const Member& m) { return n < m.first; });
        return behind != members.begin() && behind[-1].first == name ? &behind[-1].second : nullptr;
    }
    const auto at = std::find_if(members.rbegin(), members.rend(), [&](const Member& m) { return m.first == name; });
    return at == members.rend() ? nullptr : &at->second;
}

void Json::set(const std::string& name, Json value) {
    if (is_null()) value_ = Object{{}, false};
    Object& object = std::get<Object>(value_);
    if (const Json* found = find(name)) *const_cast<Json*>(found) = std::move(value);
    else {
        object.members.emplace_back(name, std::move(value));
        object.sorted = false;
    }
}

void Json::append_to(std::string& out, int indent, int depth) const {
    const auto line = [&](int d) {
        if (indent > 0) out.append(1, '\n').append(static_cast<size_t>(d * indent), ' ');
    };
    const auto list = [&](const auto& items, const char* ends, const auto& append) {
        out += ends[0];
        bool first = true;
        for (const auto& item : items) {
            if (!first) out += ',';
            first = false;
            line(depth + 1);
            append(item);
        }
        if (!first) line(depth);
        out += ends[1];
    };
    if (const bool* b = std::get_if<bool>(&value_)) out += *b ? "true" : "false";
    else if (const uint64_t* n = whole()) out += std::to_string(*n);
    else if (const int64_t* m = std::get_if<int64_t>(&value_)) out += std::to_string(*m);
    else if (const std::string* t = text()) append_quoted(out, *t);
    else if (is_array())
        list(elements(), "[]", [&](const Json& element) { element.append_to(out, indent, depth + 1); });
    else if (const Object* object = std::get_if<Object>(&value_))
        list(object->members, "{}", [&](const Member& member) {
            append_quoted(out, member.first);
            out += indent > 0 ? ": " : ":";
            member.second.append_to(out, indent, depth + 1);
        });
    else if (is_number() && std::isfinite(number())) {
        char digits[32];
        const std::string_view shortest(
            digits, static_cast<size_t>(std::to_chars(digits, digits + sizeof digits, number()).ptr - digits));
        out += shortest;
        if (shortest.find_first_of(".e") == shortest.npos) out += ".0";
    } else out += "null";
}

std::string Json::dump(int indent) const {
    std::string text;
    append_to(text, indent, 0);
    return text;
}

class JsonParser {
public:
    explicit JsonParser(std::string_view text) : text_(text) {}

    Json whole_text() {
        Json json = value(0);
        skip_blanks();
        if (at_ != text_.size()) fail();
        return json;
    }

private:
    [[noreturn]] void fail(const char* sentence = "this is not JSON") const { throw JsonError(sentence, at_); }

    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip_blanks() {
        while (at_ < text_.size() && (peek() == ' ' || peek() == '\t' || peek() == '\n' || peek() == '\r')) ++at_;
    }
    bool take(char c) {
        skip_blanks();
        const bool there = at_ < text_.size() && peek() == c;
        at_ += there;
        return there;
    }
    Json take(std::string_view word, Json json) {
        if (text_.substr(at_, word.size()) != word) fail();
        at_ += word.size();
        return json;
    }

    Json value(int depth) {
        if (depth > deepest) fail("arrays and objects are nested too deeply");
        skip_blanks();
        switch (peek()) {
        case '{': return object(depth);
        case '[': return array(depth);
        case '"': return string();
        case 't': return take("true", true);
        case 'f': return take("false", false);
        case 'n': return take("null", Json());
        default: return number();
        }
    }

    Json array(int depth) {
        ++at_;
        Json::Array elements;
        if (take(']')) return elements;
        do elements.push_back(value(depth + 1));
        while (take(','));
        if (!take(']')) fail();
        return elements;
    }

    Json object(int depth) {
        ++at_;
        Json json(std::initializer_list<Json::Member>{});
        Json::Object& object = std::get<Json::Object>(json.value_);
        if (take('}')) return json;
        do {
            skip_blanks();
            std::string name = string();
            if (!take(':')) fail();
            object.members.emplace_back(std::move(name), value(depth + 1));
        } while (take(','));
        if (!take('}')) fail();
        object.sorted = object.members.size() > few;
        if (object.sorted)
            std::stable_sort(object.members.begin(), object.members.end(),
                             [](const Json::Member& a, const Json::Member& b) { return a.first < b.first; });
        return json;
    }

    uint32_t hex4() {
        uint32_t c = 0;
        const char* const first = text_.data() + at_;
        if (text_.size() - at_ < 4 || std::from_chars(first, first + 4, c, 16).ptr != first + 4) fail();
        at_ += 4;
        return c;
    }

    std::string string() {
        if (peek() != '"') fail();
        ++at_;
        std::string text;
        for (;;) {
            if (at_ >= text_.size() || static_cast<unsigned char>(text_[at_]) < 0x20) fail();
            if (text_[at_] == '"') break;
            if (text_[at_] != '\\') {
                const size_t length = utf8_length(text_.substr(at_));
                if (length == 0) fail();
                text += text_.substr(at_, length);
                at_ += length;
                continue;
            }
            ++at_;
            const char c = peek();
            static constexpr std::string_view letters = "\"\\/bfnrt", meant = "\"\\/\b\f\n\r\t";
            if (const size_t which = letters.find(c); c != '\0' && which != letters.npos) {
                text += meant[which];
                ++at_;
            } else if (c == 'u') {
                ++at_;
                uint32_t code = hex4();
                if (code >= 0xd800 && code < 0xdc00) {
                    if (text_.substr(at_, 2) != "\\u") fail();
                    at_ += 2;
                    const uint32_t low = hex4();
                    if (low < 0xdc00 || low >= 0xe000) fail();
                    code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
                } else if (code >= 0xdc00 && code < 0xe000) fail();
                append_utf8(text, code);
            } else fail();
        }
        ++at_;
        return text;
    }

    void digits() {
        if (peek() < '0' || peek() > '9') fail();
        while (peek() >= '0' && peek() <= '9') ++at_;
    }

    Json number() {
        const size_t begin = at_;
        bool is_whole = true;
        if (peek() == '-') ++at_;
        if (peek() == '0') ++at_;
        else digits();
        if (peek() == '.') {
            is_whole = false;
            ++at_;
            digits();
        }
        if (peek() == 'e' || peek() == 'E') {
            is_whole = false;
            ++at_;
            if (peek() == '+' || peek() == '-') ++at_;
            digits();
        }
        const char *const first = text_.data() + begin, *const last = text_.data() + at_;
        if (is_whole && *first != '-') {
            uint64_t n = 0;
            if (std::from_chars(first, last, n).ec == std::errc()) return n;
        } else if (is_whole) {
            int64_t n = 0;
            if (std::from_chars(first, last, n).ec == std::errc() && n < 0) return n;
        }
        // Out of range is too small as well as too large.
        double x = 0;
        if (std::from_chars(first, last, x).ec != std::errc())
            x = std::strtod(std::string(first, last).c_str(), nullptr);
        if (!std::isfinite(x)) fail("a number is too large");
        return x;
    }

    std::string_view text_;
    size_t at_ = 0;
};

Json parse_json(std::string_view text) { return JsonParser(text).whole_text(); }

} // namespace readers
