// Vectors as wide as the instruction set that this translation unit is compiled for.
#pragma once

#include <cstdint>

#if defined(__AVX2__) && defined(__FMA__)
#define SANDGLASS_SIMD 1
#include <immintrin.h>
#endif

#ifndef SANDGLASS_ISA
#define SANDGLASS_ISA baseline
#endif

namespace sandglass {
inline namespace SANDGLASS_ISA {

/// The least of some doubles.
struct Smallest {
  double value;
  unsigned lanes;  // where it stands
};

#ifdef SANDGLASS_SIMD
// Each operation is the IEEE 754 one in every lane: the same bits as the scalar formula of the same shape.
#if defined(__AVX512F__) && defined(__AVX512DQ__)

struct Mask {
  __mmask8 bits;
  friend Mask operator&(Mask a, Mask b) { return {static_cast<__mmask8>(a.bits & b.bits)}; }
  friend Mask operator|(Mask a, Mask b) { return {static_cast<__mmask8>(a.bits | b.bits)}; }
  [[nodiscard]] unsigned lanes() const { return bits; }
};

struct Vector {
  static constexpr unsigned width = 8;
  __m512d v;
  static Vector all(double x) { return {_mm512_set1_pd(x)}; }
  static Vector load(const double* in) { return {_mm512_load_pd(in)}; }
  void store(double* out) const { _mm512_store_pd(out, v); }
  friend Vector operator+(Vector a, Vector b) { return {_mm512_add_pd(a.v, b.v)}; }
  friend Vector operator-(Vector a, Vector b) { return {_mm512_sub_pd(a.v, b.v)}; }
  friend Vector operator*(Vector a, Vector b) { return {_mm512_mul_pd(a.v, b.v)}; }
  friend Vector operator/(Vector a, Vector b) { return {_mm512_div_pd(a.v, b.v)}; }
  friend Mask operator<(Vector a, Vector b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)}; }
  friend Mask operator<=(Vector a, Vector b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ)}; }
  friend Mask operator==(Vector a, Vector b) { return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ)}; }
};
inline Vector fma(Vector a, Vector b, Vector c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
inline Vector fms(Vector a, Vector b, Vector c) { return {_mm512_fmsub_pd(a.v, b.v, c.v)}; }    // ab - c
inline Vector fnma(Vector a, Vector b, Vector c) { return {_mm512_fnmadd_pd(a.v, b.v, c.v)}; }  // c - ab
inline Vector sqrt(Vector a) { return {_mm512_sqrt_pd(a.v)}; }
inline Vector max(Vector a, Vector b) { return {_mm512_max_pd(a.v, b.v)}; }
inline Vector min(Vector a, Vector b) { return {_mm512_min_pd(a.v, b.v)}; }
inline Vector nearest_integer(Vector a) {
  return {_mm512_roundscale_pd(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
inline Vector choose(Mask m, Vector yes, Vector no) { return {_mm512_mask_blend_pd(m.bits, no.v, yes.v)}; }
inline double smallest(Vector a) { return _mm512_reduce_min_pd(a.v); }
inline Mask other_than(const std::uint32_t* entries, std::uint32_t value) {
  const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(entries));
  return {_mm256_cmpneq_epi32_mask(all, _mm256_set1_epi32(static_cast<int>(value)))};
}

inline Mask everywhere() { return {0xff}; }

/// The least of each of eight rows of eight.
inline void smallest_of_rows(const double* rows, double* out) {
  __m512d pairs[4], quarters[2];
  for (int i = 0; i < 4; ++i) {
    const __m512d a = _mm512_load_pd(rows + 16 * i), b = _mm512_load_pd(rows + 16 * i + 8);
    pairs[i] = _mm512_min_pd(_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
  }
  auto halve = [](__m512d a, __m512d b) {
    return _mm512_min_pd(_mm512_shuffle_f64x2(a, b, 0x88), _mm512_shuffle_f64x2(a, b, 0xdd));
  };
  for (int i = 0; i < 2; ++i) quarters[i] = halve(pairs[2 * i], pairs[2 * i + 1]);
  _mm512_store_pd(out, halve(quarters[0], quarters[1]));
}
inline unsigned equal_lanes(const double* row, double value) {
  return _mm512_cmp_pd_mask(_mm512_load_pd(row), _mm512_set1_pd(value), _CMP_EQ_OQ);
}

inline Smallest smallest_of_8(const double* x) {
  const Vector v = {_mm512_load_pd(x)};
  const double value = smallest(v);
  return {value, (v == Vector::all(value)).lanes()};
}

/// Transposes eight rows of eight doubles: out[c] holds column c, lane r from rows[list[r]].
/// (Addresses gathered in an array first are computed in a vector by GCC, and taken out of it one by one.)
template <class Row>
inline void load_columns(const Row* rows, const std::uint32_t* list, Vector (&out)[8]) {
  __m512d r[8], t[8];
  for (int i = 0; i < 8; ++i) r[i] = _mm512_load_pd(reinterpret_cast<const double*>(rows + list[i]));
  for (int i = 0; i < 8; i += 2) {
    t[i] = _mm512_unpacklo_pd(r[i], r[i + 1]);
    t[i + 1] = _mm512_unpackhi_pd(r[i], r[i + 1]);
  }
  // t[2i + odd]: columns 0 2 4 6 (+ odd) of rows 2i and 2i + 1, in 128-bit pieces.
  for (int odd = 0; odd < 2; ++odd) {
    const __m512d a = _mm512_shuffle_f64x2(t[odd], t[odd + 2], 0x88),
                  b = _mm512_shuffle_f64x2(t[odd], t[odd + 2], 0xdd);
    const __m512d c = _mm512_shuffle_f64x2(t[odd + 4], t[odd + 6], 0x88),
                  d = _mm512_shuffle_f64x2(t[odd + 4], t[odd + 6], 0xdd);
    out[odd].v = _mm512_shuffle_f64x2(a, c, 0x88);
    out[odd + 2].v = _mm512_shuffle_f64x2(b, d, 0x88);
    out[odd + 4].v = _mm512_shuffle_f64x2(a, c, 0xdd);
    out[odd + 6].v = _mm512_shuffle_f64x2(b, d, 0xdd);
  }
}

#else

struct Mask {
  __m256d bits;
  friend Mask operator&(Mask a, Mask b) { return {_mm256_and_pd(a.bits, b.bits)}; }
  friend Mask operator|(Mask a, Mask b) { return {_mm256_or_pd(a.bits, b.bits)}; }
  [[nodiscard]] unsigned lanes() const { return static_cast<unsigned>(_mm256_movemask_pd(bits)); }
};

struct Vector {
  static constexpr unsigned width = 4;
  __m256d v;
  static Vector all(double x) { return {_mm256_set1_pd(x)}; }
  static Vector load(const double* in) { return {_mm256_load_pd(in)}; }
  void store(double* out) const { _mm256_store_pd(out, v); }
  friend Vector operator+(Vector a, Vector b) { return {_mm256_add_pd(a.v, b.v)}; }
  friend Vector operator-(Vector a, Vector b) { return {_mm256_sub_pd(a.v, b.v)}; }
  friend Vector operator*(Vector a, Vector b) { return {_mm256_mul_pd(a.v, b.v)}; }
  friend Vector operator/(Vector a, Vector b) { return {_mm256_div_pd(a.v, b.v)}; }
  friend Mask operator<(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)}; }
  friend Mask operator<=(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)}; }
  friend Mask operator==(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_EQ_OQ)}; }
};
inline Vector fma(Vector a, Vector b, Vector c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
inline Vector fms(Vector a, Vector b, Vector c) { return {_mm256_fmsub_pd(a.v, b.v, c.v)}; }    // ab - c
inline Vector fnma(Vector a, Vector b, Vector c) { return {_mm256_fnmadd_pd(a.v, b.v, c.v)}; }  // c - ab
inline Vector sqrt(Vector a) { return {_mm256_sqrt_pd(a.v)}; }
inline Vector max(Vector a, Vector b) { return {_mm256_max_pd(a.v, b.v)}; }
inline Vector min(Vector a, Vector b) { return {_mm256_min_pd(a.v, b.v)}; }
inline Vector nearest_integer(Vector a) {
  return {_mm256_round_pd(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
inline Vector choose(Mask m, Vector yes, Vector no) { return {_mm256_blendv_pd(no.v, yes.v, m.bits)}; }
inline Mask other_than(const std::uint32_t* entries, std::uint32_t value) {
  const __m128i all = _mm_load_si128(reinterpret_cast<const __m128i*>(entries));
  const __m128i equal = _mm_cmpeq_epi32(all, _mm_set1_epi32(static_cast<int>(value)));
  const __m256i wide = _mm256_cvtepi32_epi64(_mm_xor_si128(equal, _mm_set1_epi32(-1)));
  return {_mm256_castsi256_pd(wide)};
}
inline Mask everywhere() { return {_mm256_castsi256_pd(_mm256_set1_epi32(-1))}; }
inline double smallest(Vector a) {
  const __m128d half = _mm_min_pd(_mm256_castpd256_pd128(a.v), _mm256_extractf128_pd(a.v, 1));
  return _mm_cvtsd_f64(_mm_min_sd(half, _mm_unpackhi_pd(half, half)));
}

inline void smallest_of_rows(const double* rows, double* out) {
  for (int i = 0; i < 8; i += 2, rows += 16) {
    const __m256d a = _mm256_min_pd(_mm256_load_pd(rows), _mm256_load_pd(rows + 4));
    const __m256d b = _mm256_min_pd(_mm256_load_pd(rows + 8), _mm256_load_pd(rows + 12));
    const __m256d pairs = _mm256_min_pd(_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
    _mm_store_pd(out + i, _mm_min_pd(_mm256_castpd256_pd128(pairs), _mm256_extractf128_pd(pairs, 1)));
  }
}
inline unsigned equal_lanes(const double* row, double value) {
  const Vector low = Vector::load(row), high = Vector::load(row + 4), all = Vector::all(value);
  return (low == all).lanes() | (high == all).lanes() << 4;
}

inline Smallest smallest_of_8(const double* x) {
  const Vector low = {_mm256_load_pd(x)}, high = {_mm256_load_pd(x + 4)};
  const double value = smallest({_mm256_min_pd(low.v, high.v)});
  return {value, (low == Vector::all(value)).lanes() | (high == Vector::all(value)).lanes() << 4};
}

/// Transposes four rows of eight doubles: out[c] holds column c, lane r from rows[list[r]].
template <class Row>
inline void load_columns(const Row* rows, const std::uint32_t* list, Vector (&out)[8]) {
  for (int half = 0; half < 8; half += 4) {
    __m256d r[4];
    for (int i = 0; i < 4; ++i) r[i] = _mm256_load_pd(reinterpret_cast<const double*>(rows + list[i]) + half);
    const __m256d a = _mm256_unpacklo_pd(r[0], r[1]), b = _mm256_unpackhi_pd(r[0], r[1]);
    const __m256d c = _mm256_unpacklo_pd(r[2], r[3]), d = _mm256_unpackhi_pd(r[2], r[3]);
    out[half].v = _mm256_permute2f128_pd(a, c, 0x20);
    out[half + 1].v = _mm256_permute2f128_pd(b, d, 0x20);
    out[half + 2].v = _mm256_permute2f128_pd(a, c, 0x31);
    out[half + 3].v = _mm256_permute2f128_pd(b, d, 0x31);
  }
}

#endif

/// Box::nearest.
template <class Box>
[[gnu::always_inline]] inline Vector nearest(Vector difference, const Box& box) {
  return fnma(Vector::all(box.length), nearest_integer(difference * Vector::all(box.inverse)), difference);
}

/// Which of eight points in fixed point (x and y of 32 bits each, aligned to 64 bytes) are within `range` of another in
/// both coordinates: bits 0, 2, 4 ...
inline unsigned lanes_within(const std::uint64_t* points, std::uint64_t point, std::uint32_t range) {
#if defined(__AVX512F__)
  const __m512i away = _mm512_sub_epi32(_mm512_load_si512(points), _mm512_set1_epi64(static_cast<long long>(point)));
  const unsigned within = _mm512_cmple_epu32_mask(_mm512_abs_epi32(away), _mm512_set1_epi32(static_cast<int>(range)));
#else
  unsigned within = 0;
  const __m256i limit = _mm256_set1_epi32(static_cast<int>(range));
  for (int half = 0; half < 2; ++half) {
    const __m256i away =
        _mm256_abs_epi32(_mm256_sub_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(points) + half),
                                          _mm256_set1_epi64x(static_cast<long long>(point))));
    const __m256i inside = _mm256_cmpeq_epi32(_mm256_max_epu32(away, limit), limit);
    within |= static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(inside))) << 8 * half;
  }
#endif
  return within & within >> 1 & 0x5555;
}

/// Which of eight entries, aligned to 32 bytes, equal `value`.
inline unsigned equal_lanes(const std::uint32_t* entries, std::uint32_t value) {
  const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(entries));
  const __m256i equal = _mm256_cmpeq_epi32(all, _mm256_set1_epi32(static_cast<int>(value)));
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(equal)));
}

#else

inline Smallest smallest_of_8(const double* x) {
  double value = x[0];
  for (int i = 1; i < 8; ++i) value = x[i] < value ? x[i] : value;
  unsigned lanes = 0;
  for (int i = 0; i < 8; ++i) lanes |= static_cast<unsigned>(x[i] == value) << i;
  return {value, lanes};
}

/// Which of eight entries equal `value`.
inline unsigned equal_lanes(const std::uint32_t* entries, std::uint32_t value) {
  unsigned lanes = 0;
  for (int i = 0; i < 8; ++i) lanes |= static_cast<unsigned>(entries[i] == value) << i;
  return lanes;
}

#endif

}  // namespace SANDGLASS_ISA
}  // namespace sandglass
