'use strict'; /* SPDX-License-Identifier: GPL-3.0-or-later */
/* Zoom of a chart: a range that is dragged over it becomes the page's `from` and `to`. The keys of arrows, +, - and 0
 * follow the links above it. */
(function () {
  document.querySelectorAll('figure.zoom').forEach(function (figure) {
    var svg = figure.querySelector('svg'), data = figure.dataset, start = null, mark = null, moved = false;
    var from = +data.from, to = +data.to;

    /* Place of the pointer between the chart's axes: 0 to 1. */
    function shareOf(event) {
      var box = svg.getBoundingClientRect(), x = (event.clientX - box.left) / box.width;
      return Math.min(1, Math.max(0, (x - data.left) / (data.right - data.left)));
    }

    function showRange(a, b) {
      var view = svg.viewBox.baseVal, width = (data.right - data.left) * view.width;
      if (!mark) {
        mark = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
        mark.setAttribute('class', 'chosen');
        mark.setAttribute('y', 0);
        mark.setAttribute('height', view.height);
        svg.appendChild(mark);
      }
      mark.setAttribute('x', data.left * view.width + Math.min(a, b) * width);
      mark.setAttribute('width', Math.abs(b - a) * width);
    }

    function dropRange() {
      if (mark) mark.remove();
      mark = null;
      start = null;
    }

    figure.addEventListener('dragstart', function (event) { event.preventDefault(); });
    figure.addEventListener('pointerdown', function (event) {
      if (event.button) return;
      start = shareOf(event);
      moved = false;
    });
    figure.addEventListener('pointermove', function (event) {
      if (start === null) return;
      var x = shareOf(event);
      if (!moved && Math.abs(x - start) < 0.01) return;
      if (!moved) {
        moved = true;
        figure.setPointerCapture(event.pointerId);
      }
      showRange(start, x);
    });
    figure.addEventListener('pointercancel', dropRange);
    figure.addEventListener('click', function (event) { if (moved) event.preventDefault(); }, true);
    figure.addEventListener('pointerup', function (event) {
      if (start === null) return;
      var a = start, b = shareOf(event);
      dropRange();
      if (!moved) return;
      var count = to - from + 1, url = new URL(location.href);
      var low = from + Math.floor(Math.min(a, b) * count), high = from + Math.ceil(Math.max(a, b) * count) - 1;
      low = Math.max(from, Math.min(low, to));
      high = Math.max(low, Math.min(high, to));
      url.searchParams.set('from', low);
      url.searchParams.set('to', high);
      location.href = url;
    });
  });

  /* Quantities: a search over their names, and favourites that this browser keeps and lists first. */
  (function () {
    var KEY = 'foilgauge.favourites', list = document.querySelector('select[name=q]');
    var search = document.querySelector('[data-search]'), star = document.querySelector('[data-star]');
    if (!list || !search || !star) return;
    var first = list.querySelector('optgroup'), chosen = list.value;

    function read() {
      try {
        return JSON.parse(localStorage.getItem(KEY) || '[]');
      } catch (error) {
        return []; /* a browser that keeps nothing has no favourites */
      }
    }

    function write(names) {
      try {
        localStorage.setItem(KEY, JSON.stringify(names));
      } catch (error) {
        star.hidden = true;
      }
    }

    function optionsOf(name) {
      return Array.prototype.filter.call(list.options, function (option) {
        return option.value === name && option.parentElement !== first;
      });
    }

    function show() {
      var names = read(), value = list.value, starred = names.indexOf(value) >= 0;
      first.textContent = '';
      names.forEach(function (name) {
        optionsOf(name).slice(0, 1).forEach(function (option) { first.appendChild(option.cloneNode(true)); });
      });
      first.hidden = !first.children.length;
      list.value = value;
      star.setAttribute('aria-pressed', starred);
      star.textContent = starred ? '★' : '☆';
    }

    function find() {
      var words = search.value.toLowerCase().split(/\s+/), found = null;
      Array.prototype.forEach.call(list.options, function (option) {
        var text = option.textContent.toLowerCase();
        option.hidden = option.disabled = !words.every(function (word) { return text.indexOf(word) >= 0; });
        if (!option.hidden && !found) found = option;
      });
      list.querySelectorAll('optgroup').forEach(function (group) {
        group.hidden = !group.querySelector('option:not([hidden])');
      });
      list.value = search.value && found ? found.value : chosen;
    }

    document.querySelectorAll('[data-script]').forEach(function (element) { element.hidden = false; });
    search.addEventListener('input', function () {
      find();
      show();
      if (search.value) find();
    });
    list.addEventListener('change', function () {
      chosen = list.value;
      show();
    });
    star.addEventListener('click', function () {
      var names = read(), at = names.indexOf(list.value);
      if (at >= 0) names.splice(at, 1);
      else names.push(list.value);
      write(names);
      show();
    });
    show();
  })();

  document.addEventListener('keydown', function (event) {
    if (event.ctrlKey || event.altKey || event.metaKey || /INPUT|SELECT|TEXTAREA/.test(event.target.tagName)) return;
    var key = event.key === '=' ? '+' : event.key;
    var link = document.querySelector('[data-key="' + CSS.escape(key) + '"]');
    if (link) {
      event.preventDefault();
      location.href = link.href;
    }
  });
})();
